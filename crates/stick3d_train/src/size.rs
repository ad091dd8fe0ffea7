//! Lengths that were chosen for bodies as large as people and horses, brought to those of other sizes.

/// Bodies and figures between these, metres, are trained and measured with lengths as they stand.
const USUAL_M: (f32, f32) = (1.5, 3.0);

/// How large something of `extent_m` metres is beside what is usual: 1 between one and a half metres and three, as much
/// less or more than 1 as it is smaller or larger than that.
#[must_use]
pub fn relative_size(extent_m: f32) -> f32 {
    let usual = extent_m.clamp(USUAL_M.0, USUAL_M.1);
    let share = extent_m / usual;
    if share.is_finite() && share > 0.0 {
        share
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use stick3d_figure::figure::Figure;

    use super::*;

    #[test]
    fn people_and_horses_are_usual_and_foxes_are_half_as_large() {
        for figure in Figure::shipped() {
            assert_eq!(relative_size(figure.template_extent_m()), 1.0);
        }
        assert!((relative_size(0.75) - 0.5).abs() < 1e-6);
        assert!((relative_size(30.0) - 10.0).abs() < 1e-6);
        assert_eq!(relative_size(0.0), 1.0);
        assert_eq!(relative_size(f32::NAN), 1.0);
    }
}
