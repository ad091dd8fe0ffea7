//! The order of names as people count: `mesh2` before `mesh10`.

use std::cmp::Ordering;

/// Compares runs of digits by their numbers, everything else letter by letter.
pub(super) fn compare(a: &str, b: &str) -> Ordering {
    let (mut rest_a, mut rest_b) = (a, b);
    loop {
        let (part_a, after_a) = part(rest_a);
        let (part_b, after_b) = part(rest_b);
        let order = match (is_number(part_a), is_number(part_b)) {
            (true, true) => {
                let (a, b) = (
                    part_a.trim_start_matches('0'),
                    part_b.trim_start_matches('0'),
                );
                a.len().cmp(&b.len()).then_with(|| a.cmp(b))
            }
            _ => part_a.cmp(part_b),
        };
        if order != Ordering::Equal {
            return order;
        }
        if part_a.is_empty() {
            // `mesh01` and `mesh1` count alike; their order must still be one.
            return a.cmp(b);
        }
        (rest_a, rest_b) = (after_a, after_b);
    }
}

fn is_number(part: &str) -> bool {
    part.starts_with(|c: char| c.is_ascii_digit())
}

/// The longest beginning that is all digits or has none, and the rest.
fn part(text: &str) -> (&str, &str) {
    let digits = is_number(text);
    let end = text
        .find(|c: char| c.is_ascii_digit() != digits)
        .unwrap_or(text.len());
    text.split_at(end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_count() {
        let mut names = [
            "mesh10.off",
            "mesh2.off",
            "mesh1.off",
            "mesh02.off",
            "horse-1",
            "mesh",
        ];
        names.sort_by(|a, b| compare(a, b));
        let expected = [
            "horse-1",
            "mesh",
            "mesh1.off",
            "mesh02.off",
            "mesh2.off",
            "mesh10.off",
        ];
        assert_eq!(names, expected);
        assert_eq!(
            compare("a99999999999999999999999", "a100000000000000000000000"),
            Ordering::Less
        );
        assert_eq!(compare("x", "x"), Ordering::Equal);
    }
}
