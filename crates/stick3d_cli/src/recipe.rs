//! Other values for parts of a training recipe, by name.

use anyhow::{Context as _, anyhow};
use serde_json::Value;
use stick3d_train::training::TrainConfig;

use crate::failure::{Failure, Outcome};

/// The recipe with changes such as `loss.alpha=1e4`: a path of names or numbers to a part there is, and its value as JSON.
pub(crate) fn changed(recipe: TrainConfig, changes: &[String]) -> Outcome<TrainConfig> {
    if changes.is_empty() {
        return Ok(recipe);
    }
    let apply = || {
        let mut tree = serde_json::to_value(&recipe)?;
        for change in changes {
            apply_one(&mut tree, change).with_context(|| format!("cannot set `{change}`"))?;
        }
        Ok(serde_json::from_value(tree)?)
    };
    apply().map_err(|error: anyhow::Error| Failure::input(error))
}

fn apply_one(tree: &mut Value, change: &str) -> anyhow::Result<()> {
    let (path, text) = change
        .split_once('=')
        .ok_or_else(|| anyhow!("write PART=VALUE, as in hypotheses=1"))?;
    let value = serde_json::from_str(text).context("the value is no JSON")?;
    let mut at = tree;
    for name in path.split('.') {
        let names: Vec<String> = match &*at {
            Value::Object(map) => map.keys().cloned().collect(),
            Value::Array(list) => (0..list.len()).map(|i| i.to_string()).collect(),
            _ => vec![],
        };
        let next = match at {
            Value::Object(map) => map.get_mut(name),
            Value::Array(list) => name.parse().ok().and_then(|i: usize| list.get_mut(i)),
            _ => None,
        };
        at =
            next.ok_or_else(|| anyhow!("there is no `{name}`; there are: {}", names.join(", ")))?;
    }
    *at = value;
    Ok(())
}

#[cfg(test)]
mod tests {
    use stick3d_figure::figure::Figure;

    use super::*;

    fn change(change: &str) -> Result<TrainConfig, String> {
        let recipe = TrainConfig::of(Figure::human());
        changed(recipe, &[change.to_owned()]).map_err(|failure| failure.message())
    }

    #[test]
    fn parts_are_changed_by_their_path() {
        assert_eq!(change("hypotheses=3").unwrap().hypotheses, 3);
        assert_eq!(change("loss.alpha=1e4").unwrap().loss.alpha, 1e4);
        assert_eq!(change("stages.2.epochs=5").unwrap().stages[2].epochs, 5);
        let expected = TrainConfig::of(Figure::human());
        assert_eq!(change("seed=1").unwrap(), expected);
    }

    #[test]
    fn what_is_not_there_is_named() {
        for (wrong, hint) in [
            ("hypothesis=3", "hypotheses"),
            ("stages.3.epochs=5", "0, 1, 2"),
            ("hypotheses", "PART=VALUE"),
            ("hypotheses=many", "JSON"),
            ("hypotheses=\"many\"", "invalid type"),
        ] {
            let error = change(wrong).unwrap_err();
            assert!(error.contains(hint), "{wrong}: {error}");
        }
    }
}
