//! The nearest known name, for errors that say what was probably meant.

/// The known name that is most like `given`, or none when nothing is near enough to be a likely slip.
pub fn nearest<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // A very long name is no slip of the pen, and comparing costs the product of both lengths.
    if given.len() > 64 {
        return None;
    }
    let given = given.to_lowercase();
    known
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&given, &name.to_lowercase()), name))
        .filter(|(likeness, _)| *likeness > 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

/// The ending of an error about an unknown name: what was probably meant, else what there is.
pub fn suggestion<'a>(given: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    match nearest(given, known.clone()) {
        Some(name) => format!("did you mean \"{name}\"?"),
        None => {
            let all: Vec<&str> = known.into_iter().take(24).collect();
            format!("known are: {}", all.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised_and_nonsense_is_not() {
        let known = ["elbow_r", "elbow_l", "hand_r", "forehead"];
        assert_eq!(nearest("elbo_r", known), Some("elbow_r"));
        assert_eq!(nearest("Forhead", known), Some("forehead"));
        assert_eq!(nearest("xyzzy", known), None);
        assert!(suggestion("xyzzy", known).contains("elbow_l"));
    }
}
