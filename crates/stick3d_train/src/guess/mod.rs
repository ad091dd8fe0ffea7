//! Guessing a first figure for a rigged body: where its joints are, from the names of its bones and from its shape.
//!
//! Names are read as words and a side, in the habits of the usual programs ([`words`] holds them as data). Where they say
//! nothing, the skeleton's shape does: bones that mirror each other are limbs, limbs that reach the ground are legs,
//! one pair of legs is a body that stands and two are one that walks on all fours. What comes out has the joints and the
//! path of a shipped figure, anchored on the rig's own bones, with the rig at rest as template. What could not be
//! guessed is said, joint by joint.
//!
//! The template is the body as it is usually drawn, +x right, +y up: one that stands from the front, one that walks
//! on all fours from its right side. Rigs may face any way; the template does not depend on it.

mod anchors;
mod biped;
mod body;
mod error;
mod limbs;
mod name;
mod plan;
mod quadruped;
mod symmetry;
mod template;
#[cfg(test)]
mod tests;
mod words;

use glam::Vec3;
use stick3d_figure::{Anchor, Figure};

use crate::rig::Rig;
use anchors::Anchors;
use body::{Body, Flesh};
pub use error::{GuessError, JointFault};
use plan::{Finding, View};
use symmetry::Symmetry;

/// A first figure for a rig.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Guess {
    /// The figure. Joints with a fault are anchored on no vertex, which training refuses.
    pub figure: Figure,
    /// The joints that were not guessed, and why.
    pub faults: Vec<JointFault>,
    /// What else a person should know, in sentences.
    pub notes: Vec<String>,
    /// The way that the body faces in its file, a horizontal unit vector.
    pub forward: Vec3,
}

/// Where the joints of a body are, before they are put on its surface.
#[derive(Debug)]
struct Found {
    /// The shipped figure that has these joints.
    like: &'static Figure,
    findings: Vec<Finding>,
    symmetry: Symmetry,
    forward: Vec3,
    /// The direction that is right in the template.
    right: Vec3,
    notes: Vec<String>,
}

/// Guesses a figure called `name` for a rig.
///
/// # Errors
/// [`GuessError`] where not even the plan of the body can be told; single joints that were not guessed are no error but
/// [`Guess::faults`].
pub fn guess(rig: &Rig, name: &str) -> Result<Guess, GuessError> {
    let body = Body::new(&rig.skeleton, &Flesh::of(rig));
    let mut found = find(&body)?;
    let anchors = Anchors {
        rig,
        body: &body,
        symmetry: &found.symmetry,
        forward: found.forward,
    };
    let mut figure = found.like.clone();
    name.clone_into(&mut figure.name);
    let mut faults = Vec::new();
    let mut places = vec![None; figure.joint_count()];
    let mut unnamed = Vec::new();
    for finding in &found.findings {
        let index = figure.joint_index(&finding.joint)?;
        let anchor = match &finding.place {
            Ok(place) => anchors.of(place, &figure, &figure.joints[index]),
            Err(fault) => {
                faults.push(fault.clone());
                Anchor::Vertices(Vec::new())
            }
        };
        places[index] = finding.place.is_ok().then(|| anchors.position(&anchor));
        figure.joints[index].anchor = anchor;
        if finding.place.is_ok() && !finding.named {
            unnamed.push(finding.joint.clone());
        }
    }
    figure.template = template::template(&figure, &places, found.right, rig);
    let unit_m = template::unit_m(rig);
    if unit_m != 1.0 {
        found.notes.push(format!(
            "the body is too large to be in metres, as glTF has it; its unit is taken as {unit_m} m"
        ));
    }
    let absent: Vec<String> = figure
        .joints
        .iter()
        .filter(|joint| !found.findings.iter().any(|f| f.joint == joint.name))
        .map(|joint| joint.name.clone())
        .collect();
    for joint in &absent {
        figure = figure.without(joint)?;
        found.notes.push(format!(
            "the body has no {joint}; the figure is drawn without"
        ));
    }
    if !unnamed.is_empty() {
        found.notes.push(format!(
            "found by the shape of the skeleton, not by names: {}",
            unnamed.join(", ")
        ));
    }
    Ok(Guess {
        // What the file's reader checks holds of what is written, too.
        figure: Figure::from_ron(&figure.to_ron()?)?,
        faults,
        notes: found.notes,
        forward: found.forward,
    })
}

/// Tells the plan of a body and finds its joints.
fn find(body: &Body) -> Result<Found, GuessError> {
    let Some(symmetry) = Symmetry::find(body) else {
        let names = body.living().take(24).map(|bone| body.name(bone));
        return Err(GuessError::NoPairs {
            bones: names.collect(),
        });
    };
    let view = View::new(body, symmetry);
    let begins = |pairs: &[limbs::LimbPair]| -> Vec<String> {
        let roots = pairs.iter().flat_map(limbs::LimbPair::roots);
        roots.map(|bone| body.name(bone)).collect()
    };
    match view.limbs.legs.len() {
        2 => Ok(on_four_legs(view)),
        0 if !biped::is_named(&view) => Err(GuessError::NoLegs {
            limbs: begins(&view.limbs.free),
        }),
        0 | 1 => Ok(on_two_legs(view)),
        _ => Err(GuessError::ManyLegs {
            legs: begins(&view.limbs.legs),
        }),
    }
}

fn on_two_legs(view: View<'_>) -> Found {
    let mut notes = Vec::new();
    let toes = biped::toes_forward(&view);
    let mut view = view;
    if view.symmetry.named {
        if toes < 0.0 {
            notes.push(
                "the feet point backward if bones called left are on the body's left, as was assumed"
                    .to_owned(),
            );
        }
    } else {
        notes.push("no names say what is left and right; the way it faces does".to_owned());
        let way = if toes == 0.0 {
            let usual = view.forward().dot(Vec3::new(0.5, 0.0, 1.0));
            notes.push(format!(
                "the feet do not say which way the body faces; {} was assumed",
                direction(usual.signum() * view.forward())
            ));
            usual
        } else {
            toes
        };
        if way < 0.0 {
            view = view.flipped();
        }
    }
    Found {
        like: Figure::human(),
        findings: biped::joints(&view),
        forward: view.forward(),
        // Seen from the front the figure's left is on the right.
        right: view.symmetry.across,
        symmetry: view.symmetry,
        notes,
    }
}

fn on_four_legs(view: View<'_>) -> Found {
    let mut notes = Vec::new();
    let mut view = view;
    let ahead = quadruped::Legs::order(&view).map_or(1.0, |legs| legs.forward(&view));
    if ahead < 0.0 {
        if view.symmetry.named {
            notes.push(
                "bones called left are on the right of a body that walks head first; they count as right"
                    .to_owned(),
            );
        }
        view = view.flipped();
    }
    let legs = quadruped::Legs::order(&view);
    if legs.as_ref().is_some_and(|legs| !legs.clear) {
        notes.push(format!(
            "neither names nor shape say where the head is; it was assumed toward {}",
            direction(view.forward())
        ));
    }
    Found {
        like: Figure::horse(),
        findings: legs.map_or_else(Vec::new, |legs| quadruped::joints(&view, &legs)),
        forward: view.forward(),
        // Seen from its right side it walks to the right.
        right: view.forward(),
        symmetry: view.symmetry,
        notes,
    }
}

/// A horizontal direction in words: an axis of the file, or degrees from +Z toward +X.
#[must_use]
pub fn direction(forward: Vec3) -> String {
    let axes = [
        (Vec3::X, "+X"),
        (Vec3::NEG_X, "-X"),
        (Vec3::Z, "+Z"),
        (Vec3::NEG_Z, "-Z"),
    ];
    let near = axes.iter().find(|(axis, _)| axis.dot(forward) > 0.999);
    near.map_or_else(
        || {
            let degrees = forward.x.atan2(forward.z).to_degrees();
            format!("{degrees:.0} degrees from +Z toward +X")
        },
        |(_, name)| (*name).to_owned(),
    )
}
