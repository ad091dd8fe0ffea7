//! A small software renderer for contact sheets, without GPU or display.
