//! Joining vertices that coincide.
//!
//! A file repeats a vertex wherever its normal, texture coordinate or material changes. As a surface that
//! bends, the copies are one.

use std::collections::HashMap;

use glam::{IVec3, Vec3};

use super::surface::Surface;

/// Vertices this near to each other coincide, as a share of the surface's largest extent.
const NEAR: f32 = 1e-6;

/// Copies of one vertex follow the same bones; vertices of different things that touch do not.
const LARGEST_WEIGHT_DIFFERENCE: f32 = 0.02;

/// Which vertices at one place become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weld {
    /// Those of the same colour: the borders between colours stay sharp.
    #[default]
    KeepColorBorders,
    /// All: the surface is as closed as it was modelled, and colours are per triangle
    /// ([`RigFile::triangle_colors`](super::RigFile::triangle_colors)).
    ByPosition,
}

impl Surface {
    /// Joins vertices; returns how many disappeared. Those that stay keep their order.
    pub(super) fn weld(&mut self, weld: Weld) -> usize {
        let before = self.positions.len();
        let map = self.representatives(weld);
        let mut number = vec![0_u32; before];
        let mut kept = 0_u32;
        for vertex in 0..before {
            number[vertex] = if map[vertex] == vertex {
                kept += 1;
                kept - 1
            } else {
                number[map[vertex]]
            };
        }
        let stays = |vertex: usize| map[vertex] == vertex;
        retain(&mut self.positions, stays);
        retain(&mut self.influences, stays);
        retain(&mut self.colors, stays);
        for corner in self.triangles.as_flattened_mut() {
            *corner = number[*corner as usize];
        }
        before - kept as usize
    }

    /// Per vertex the first one that it coincides with, itself if there is none.
    fn representatives(&self, weld: Weld) -> Vec<usize> {
        let low = self
            .positions
            .iter()
            .copied()
            .fold(Vec3::INFINITY, Vec3::min);
        let high = self
            .positions
            .iter()
            .copied()
            .fold(Vec3::NEG_INFINITY, Vec3::max);
        let near = ((high - low).max_element() * NEAR).max(f32::MIN_POSITIVE);
        let cell = |point: Vec3| ((point - low) / (4.0 * near)).floor().as_ivec3();
        let mut cells: HashMap<IVec3, Vec<usize>> = HashMap::with_capacity(self.positions.len());
        (0..self.positions.len())
            .map(|vertex| {
                let point = self.positions[vertex];
                let (from, to) = (cell(point - near), cell(point + near));
                let mut candidates = (from.x..=to.x)
                    .flat_map(|x| (from.y..=to.y).map(move |y| (x, y)))
                    .flat_map(|(x, y)| (from.z..=to.z).map(move |z| IVec3::new(x, y, z)))
                    .filter_map(|cell| cells.get(&cell))
                    .flatten()
                    .copied();
                let found = candidates.find(|&other| {
                    self.positions[other].distance(point) <= near
                        && (weld == Weld::ByPosition || self.colors[other] == self.colors[vertex])
                        && self.follow_alike(other, vertex)
                });
                found.unwrap_or_else(|| {
                    cells.entry(cell(point)).or_default().push(vertex);
                    vertex
                })
            })
            .collect()
    }

    fn follow_alike(&self, first: usize, second: usize) -> bool {
        let (first, second) = (&self.influences[first], &self.influences[second]);
        let weight = |list: &[(u16, f32)], joint: u16| {
            list.iter()
                .find(|(other, _)| *other == joint)
                .map_or(0.0, |(_, weight)| *weight)
        };
        first.iter().chain(second).all(|&(joint, _)| {
            (weight(first, joint) - weight(second, joint)).abs() <= LARGEST_WEIGHT_DIFFERENCE
        })
    }
}

fn retain<T>(list: &mut Vec<T>, keep: impl Fn(usize) -> bool) {
    let mut index = 0;
    list.retain(|_| {
        index += 1;
        keep(index - 1)
    });
}
