//! Reading the base mesh: an OBJ file of quads in named groups.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::format::{Fault, Record, each_record};

/// The vertices and the named groups of quads of an OBJ file.
pub(super) struct Obj {
    /// The vertices, in the file's unit.
    pub(super) positions: Vec<DVec3>,
    /// Per group its quads, vertices counted from 0.
    pub(super) groups: BTreeMap<String, Vec<[u32; 4]>>,
}

impl Obj {
    /// Parses the text.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut obj = Self {
            positions: Vec::new(),
            groups: BTreeMap::new(),
        };
        let mut group = String::new();
        each_record(text, |record| {
            match record {
                Record::Vertex(at, _) => obj.positions.push(at.into()),
                Record::Group(name) => name.clone_into(&mut group),
                Record::Face(corners) => {
                    let quad = corners.try_into().map_err(|_| {
                        Fault::Unsupported(format!("a face of {} corners", corners.len()))
                    })?;
                    obj.groups.entry(group.clone()).or_default().push(quad);
                }
            }
            Ok(())
        })
        .map_err(|error| error.to_string())?;
        Ok(obj)
    }

    /// The quads of a group.
    pub(super) fn quads(&self, group: &str) -> Result<&[[u32; 4]], String> {
        self.groups
            .get(group)
            .map(Vec::as_slice)
            .ok_or_else(|| format!("there is no group `{group}`"))
    }

    /// The mean of a group's vertices: for a cube round a joint, where the joint is.
    pub(super) fn group_center(&self, group: &str, at: &[DVec3]) -> Result<DVec3, String> {
        self.group_ball(group, at).map(|(center, _)| center)
    }

    /// The mean of a group's vertices and the smallest distance of one from it.
    pub(super) fn group_ball(&self, group: &str, at: &[DVec3]) -> Result<(DVec3, f64), String> {
        let mut vertices: Vec<u32> = self.quads(group)?.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let points = || vertices.iter().map(|&vertex| at[vertex as usize]);
        let center = points().sum::<DVec3>() / vertices.len().max(1) as f64;
        let radius = points()
            .map(|point| point.distance(center))
            .fold(f64::INFINITY, f64::min);
        Ok((center, radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str =
        "# a square\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\ng square\nf 1/1 2/2 3/3 4/4\n";

    #[test]
    fn groups_and_their_centers() {
        let obj = Obj::parse(SQUARE).unwrap();
        assert_eq!(obj.quads("square").unwrap(), [[0, 1, 2, 3]]);
        let center = obj.group_center("square", &obj.positions).unwrap();
        assert_eq!(center, DVec3::new(1.0, 1.0, 0.0));
        assert!(obj.quads("circle").unwrap_err().contains("circle"));
    }

    #[test]
    fn faults_name_their_line() {
        for (text, line) in [("v 0 0\n", "line 1"), ("v 0 0 0\nf 1 1 1\n", "line 2")] {
            assert!(
                Obj::parse(text)
                    .err()
                    .is_some_and(|what| what.starts_with(line))
            );
        }
        let missing = SQUARE.replace("4/4", "5/4");
        assert!(
            Obj::parse(&missing)
                .err()
                .is_some_and(|what| what.contains("vertex 5"))
        );
    }
}
