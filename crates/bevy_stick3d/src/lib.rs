//! A Bevy plugin that turns drawn stick figures into posed 3D bodies.
