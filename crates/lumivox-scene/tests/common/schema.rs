//! As much of JSON Schema (draft 2020-12) as the scene file's schema uses. A keyword that is not known here panics, so
//! that nothing in the schema goes unchecked.

use serde_json::Value;

/// Keywords that only inform.
const NOTES: &[&str] = &["$schema", "$defs", "title", "description", "default"];

/// What is wrong with a document, or `None`.
pub(crate) fn fault(schema: &Value, document: &Value) -> Option<String> {
    check(schema, schema, document, "")
}

fn check(root: &Value, schema: &Value, value: &Value, at: &str) -> Option<String> {
    let rules = schema.as_object().expect("a schema is an object");
    rules.iter().find_map(|(word, rule)| rule_fault(root, schema, word, rule, value, at))
}

fn rule_fault(
    root: &Value,
    schema: &Value,
    word: &str,
    rule: &Value,
    value: &Value,
    at: &str,
) -> Option<String> {
    let fail = |holds: bool| (!holds).then(|| format!("{at}: {word} {rule}"));
    let passes = |schema: &Value| check(root, schema, value, at).is_none();
    let all = |list: &Value| list.as_array().expect("a list").clone();
    match word {
        _ if NOTES.contains(&word) => None,
        "$ref" => {
            let path = rule.as_str().and_then(|r| r.strip_prefix('#')).expect("a local reference");
            check(root, root.pointer(path).expect("a reference to something"), value, at)
        }
        "type" => fail(match rule.as_str() {
            Some("object") => value.is_object(),
            Some("array") => value.is_array(),
            Some("string") => value.is_string(),
            Some("number") => value.is_number(),
            Some("integer") => value.is_u64() || value.is_i64(),
            Some("boolean") => value.is_boolean(),
            other => panic!("type {other:?}"),
        }),
        "const" => fail(value == rule),
        "enum" => fail(all(rule).contains(value)),
        "minimum" => {
            fail(value.as_f64().is_none_or(|v| v >= rule.as_f64().expect("a rule of the right kind")))
        }
        "maximum" => {
            fail(value.as_f64().is_none_or(|v| v <= rule.as_f64().expect("a rule of the right kind")))
        }
        "exclusiveMinimum" => {
            fail(value.as_f64().is_none_or(|v| v > rule.as_f64().expect("a rule of the right kind")))
        }
        "exclusiveMaximum" => {
            fail(value.as_f64().is_none_or(|v| v < rule.as_f64().expect("a rule of the right kind")))
        }
        "minItems" => fail(
            value
                .as_array()
                .is_none_or(|v| v.len() as u64 >= rule.as_u64().expect("a rule of the right kind")),
        ),
        "maxItems" => fail(
            value
                .as_array()
                .is_none_or(|v| v.len() as u64 <= rule.as_u64().expect("a rule of the right kind")),
        ),
        "items" => {
            let items = value.as_array().into_iter().flatten().enumerate();
            items.map(|(i, v)| check(root, rule, v, &format!("{at}/{i}"))).find_map(|f| f)
        }
        "required" => fail(
            all(rule).iter().all(|key| value.get(key.as_str().expect("a rule of the right kind")).is_some()),
        ),
        "properties" => {
            let known = rule.as_object().expect("a rule of the right kind").iter();
            known.filter_map(|(k, s)| check(root, s, value.get(k)?, &format!("{at}/{k}"))).next()
        }
        "additionalProperties" => {
            assert_eq!(rule, &Value::Bool(false));
            let known = schema["properties"].as_object().expect("a rule of the right kind");
            let keys = value.as_object().into_iter().flatten().map(|(k, _)| k);
            keys.filter(|k| !known.contains_key(*k)).map(|k| format!("{at}: unknown key {k}")).next()
        }
        "dependentSchemas" => {
            let rules = rule
                .as_object()
                .expect("a rule of the right kind")
                .iter()
                .filter(|(key, _)| value.get(key).is_some());
            rules.filter_map(|(_, s)| check(root, s, value, at)).next()
        }
        "anyOf" => fail(all(rule).iter().any(passes)),
        "oneOf" => fail(all(rule).iter().filter(|s| passes(s)).count() == 1),
        "not" => fail(!passes(rule)),
        _ => panic!("the keyword {word} is not known here"),
    }
}
