//! The three training stages of the paper (section 4.3).
