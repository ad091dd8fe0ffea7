//! Small tools of those who colour a body.

/// 0 below 0, 1 above 1, smooth between.
pub(super) fn smoothstep(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The linear colour of a screen colour 0xRRGGBB (IEC 61966-2-1, by its usual square-cube fit).
pub(super) const fn srgb_hex(rgb: u32) -> [u8; 4] {
    let mut linear = [255; 4];
    let mut part = 0;
    while part < 3 {
        let s = ((rgb >> (16 - 8 * part)) & 255) as f64 / 255.0;
        let value = s * (s * (s * 0.305_306_011 + 0.682_171_111) + 0.012_522_878);
        linear[part as usize] = (value * 255.0 + 0.5) as u8;
        part += 1;
    }
    linear
}
