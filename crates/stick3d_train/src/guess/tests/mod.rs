//! Tests of guessing on skeletons as other programs name them, and on bodies without names.
