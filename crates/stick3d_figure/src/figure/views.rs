//! From where a figure is usually drawn.

use serde::{Deserialize, Serialize};

/// From where a figure is usually drawn: how far bodies are turned before training draws them, degrees
/// either way from the view of the template.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Views {
    /// About the vertical axis.
    pub yaw_deg: f32,
    /// Whether half of the bodies are also turned about, so that they face the other way.
    #[serde(default)]
    pub both_ways: bool,
    /// In the plane of the drawing.
    pub roll_deg: f32,
    /// Toward the viewer.
    pub pitch_deg: f32,
    /// Share of the bodies that stand about upright instead of rolling anywhere within `roll_deg`.
    pub upright_share: f32,
}

impl Default for Views {
    /// From the front and either side, tilted at will.
    fn default() -> Self {
        Self {
            yaw_deg: 90.0,
            both_ways: false,
            roll_deg: 45.0,
            pitch_deg: 10.0,
            upright_share: 0.3,
        }
    }
}

impl Views {
    /// What is wrong with them, if anything.
    pub(super) fn fault(&self) -> Option<String> {
        let angles = [
            ("yaw_deg", self.yaw_deg),
            ("roll_deg", self.roll_deg),
            ("pitch_deg", self.pitch_deg),
        ];
        let wrong = angles
            .into_iter()
            .find(|(_, degrees)| !(0.0..=180.0).contains(degrees));
        if let Some((name, degrees)) = wrong {
            return Some(format!(
                "{name} of the views is {degrees}; degrees between 0 and 180 are expected"
            ));
        }
        (!(0.0..=1.0).contains(&self.upright_share)).then(|| {
            format!(
                "upright_share of the views is {}; a share between 0 and 1 is expected",
                self.upright_share
            )
        })
    }

    /// Whether they are the usual ones.
    pub(super) fn are_usual(&self) -> bool {
        *self == Self::default()
    }
}
