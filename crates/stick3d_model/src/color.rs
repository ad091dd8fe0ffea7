//! Colours: linear light and its encoding for screens.

/// A linear brightness, 1 = white, as the sRGB byte that screens and text formats hold (IEC 61966-2-1).
#[must_use]
pub fn srgb_byte(linear: f32) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * encoded).round() as u8
}

/// The other way: an sRGB brightness between 0 and 1 as a linear byte, 255 = 1, as glTF's vertex colours hold it.
#[must_use]
pub fn linear_byte(srgb: f32) -> u8 {
    let x = srgb.clamp(0.0, 1.0);
    let linear = if x <= 0.040_45 {
        x / 12.92
    } else {
        ((x + 0.055) / 1.055).powf(2.4)
    };
    (255.0 * linear).round() as u8
}

#[cfg(test)]
mod tests {
    use super::{linear_byte, srgb_byte};

    #[test]
    fn the_ways_are_inverse_to_each_other() {
        // Bright linear bytes are closer together than the screen's are: there and back may be off by one.
        for byte in 0..=255_u8 {
            let there = srgb_byte(f32::from(byte) / 255.0);
            assert!(
                linear_byte(f32::from(there) / 255.0).abs_diff(byte) <= 1,
                "{byte}"
            );
        }
        assert_eq!([0.0, 0.5, 1.0, 2.0].map(linear_byte), [0, 55, 255, 255]);
    }

    #[test]
    fn the_curve_is_the_standards() {
        // The ends, what lies beyond them, the middle grey of photographers, and the straight part near black.
        for (linear, byte) in [
            (0.0, 0),
            (1.0, 255),
            (7.0, 255),
            (-1.0, 0),
            (0.18, 118),
            (0.002, 7),
        ] {
            assert_eq!(srgb_byte(linear), byte, "{linear}");
        }
    }
}
