//! Models and their parameters as texts that end with a zero byte, made once for as long as the
//! program runs.

use std::ffi::{CStr, CString, c_char};
use std::sync::LazyLock;

use friction_model::{AnyParameters, ModelName, Parameter};

/// One parameter of a model. The texts stay as long as the program runs.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct FrictionParameter {
    /// Name, as values and files have it.
    pub name: *const c_char,
    /// What it is, in a sentence.
    pub meaning: *const c_char,
    /// Unit on a rotary axis, for instance `N m s/rad`; empty for a pure number.
    pub rotary_unit: *const c_char,
    /// Unit on a linear axis, for instance `N s/m`; empty for a pure number.
    pub linear_unit: *const c_char,
    /// Which values it may have, in words.
    pub range: *const c_char,
    /// Whether it may be left out.
    pub optional: bool,
    /// Whether it is a list: values of the same name make it, in their order.
    pub list: bool,
}

/// A model, as texts.
#[derive(Debug)]
pub struct Model {
    /// Its name in files.
    pub name: CString,
    /// Its name in headings.
    pub title: CString,
    rows: Vec<Row>,
}

#[derive(Debug)]
struct Row {
    name: CString,
    meaning: CString,
    rotary_unit: CString,
    linear_unit: CString,
    range: CString,
    optional: bool,
    list: bool,
}

impl Row {
    fn new(row: &Parameter, list: bool) -> Self {
        Self {
            name: words(row.name),
            meaning: words(row.meaning),
            rotary_unit: words(row.unit.rotary()),
            linear_unit: words(row.unit.linear()),
            range: words(&row.range.to_string()),
            optional: row.optional,
            list,
        }
    }
}

impl Model {
    /// How many parameters it has.
    pub fn parameters(&self) -> usize {
        self.rows.len()
    }

    /// One of its parameters.
    pub fn parameter(&self, index: usize) -> Option<FrictionParameter> {
        self.rows.get(index).map(|row| FrictionParameter {
            name: row.name.as_ptr(),
            meaning: row.meaning.as_ptr(),
            rotary_unit: row.rotary_unit.as_ptr(),
            linear_unit: row.linear_unit.as_ptr(),
            range: row.range.as_ptr(),
            optional: row.optional,
            list: row.list,
        })
    }
}

/// Every model, in the order of the documentation.
pub fn models() -> &'static [Model] {
    static MODELS: LazyLock<Vec<Model>> = LazyLock::new(|| {
        let model = |name: ModelName| {
            let parameters = AnyParameters::test_bed(name);
            let is_list = |row: &Parameter| form(&parameters, row.name) == Form::List;
            Model {
                name: words(name.as_str()),
                title: words(name.title()),
                rows: parameters.table().iter().map(|row| Row::new(row, is_list(row))).collect(),
            }
        };
        ModelName::ALL.map(model).into()
    });
    &MODELS
}

/// The text of a model's name; it stays as long as the program runs.
pub fn name(of: ModelName) -> &'static CStr {
    let place = ModelName::ALL.iter().position(|name| *name == of);
    place.and_then(|place| models().get(place)).map_or(c"", |model| &model.name)
}

/// How a parameter stands in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A number.
    Number,
    /// A whole number.
    Whole,
    /// A list of numbers.
    List,
}

/// How the parameter of that name stands in a file.
pub fn form(parameters: &AnyParameters, name: &str) -> Form {
    let written = serde_json::to_value(parameters).unwrap_or_default();
    match &written[parameters.name().as_str()][name] {
        serde_json::Value::Array(_) => Form::List,
        serde_json::Value::Number(number) if !number.is_f64() => Form::Whole,
        _ => Form::Number,
    }
}

/// Names and sentences of the sources, which have no zero byte.
fn words(text: &str) -> CString {
    CString::new(text).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_and_parameter_has_its_words() {
        assert_eq!(models().len(), ModelName::ALL.len());
        for (model, of) in models().iter().zip(ModelName::ALL) {
            assert_eq!(name(of).to_str().unwrap(), of.as_str());
            assert!(!model.title.is_empty() && model.parameters() > 0);
            assert!(model.rows.iter().all(|row| !row.name.is_empty() && !row.meaning.is_empty()));
            assert!(model.parameter(model.parameters()).is_none());
        }
        let lists: usize =
            models().iter().flat_map(|model| &model.rows).filter(|row| row.list).count();
        assert!(lists >= 4, "{lists}");
    }
}
