//! Keys of a JSON document that this version does not know: found, named, and put back when it is written.

use serde_json::{Map, Value};

/// The keys of `read`, at every depth, that `known` does not have, with what is in them.
pub fn beyond(read: &Value, known: &Value) -> Map<String, Value> {
    let (Value::Object(read), Value::Object(known)) = (read, known) else { return Map::new() };
    let rest = |(key, value): (&String, &Value)| {
        let Some(known) = known.get(key) else { return Some((key.clone(), value.clone())) };
        let inside = beyond(value, known);
        (!inside.is_empty()).then(|| (key.clone(), Value::Object(inside)))
    };
    read.iter().filter_map(rest).collect()
}

/// Puts the keys back into `document`, where it does not have them by now.
pub fn merge(unknown: &Map<String, Value>, document: &mut Value) {
    let Value::Object(document) = document else { return };
    for (key, value) in unknown {
        match (value, document.get_mut(key)) {
            (_, None) => drop(document.insert(key.clone(), value.clone())),
            (Value::Object(inside), Some(known)) => merge(inside, known),
            (_, Some(_)) => {}
        }
    }
}

/// Every value's place, as in `fit.pace`.
pub fn names(unknown: &Map<String, Value>) -> Vec<String> {
    let name = |(key, value): (&String, &Value)| match value {
        Value::Object(inside) if !inside.is_empty() => {
            names(inside).iter().map(|name| format!("{key}.{name}")).collect()
        }
        _ => vec![key.clone()],
    };
    unknown.iter().flat_map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_beyond_and_merged_again_makes_the_document_whole() {
        let read = serde_json::json!({"a": {"b": 1, "c": {"d": 2}}, "e": [3], "f": {"g": {}}});
        let known = serde_json::json!({"a": {"b": 7}, "f": null});
        let unknown = beyond(&read, &known);
        assert_eq!(names(&unknown), ["a.c.d", "e"]);
        let mut document = known;
        merge(&unknown, &mut document);
        assert_eq!(document, serde_json::json!({"a": {"b": 7, "c": {"d": 2}}, "e": [3], "f": null}));
    }
}
