//! The friction models of an `identification.json`, read back; of a driven axis its inertia, friction
//! and loads, as far as they are the same both ways.

use friction_model::{AnyModel, AnyParameters, ModelName};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use work::BadInput;
use work::model_name::model_name;

/// An identification, as far as its document tells it.
#[derive(Debug, Clone)]
pub struct Report {
    /// What the document is called.
    pub name: String,
    /// Lowest and highest speed of the recordings \[rad/s or m/s\].
    pub speeds: Option<[f64; 2]>,
    /// The models, best first where they were compared.
    pub models: Vec<Reported>,
    chosen: Option<ModelName>,
}

/// A model of it.
#[derive(Debug, Clone)]
pub struct Reported {
    /// Which.
    pub model: ModelName,
    /// Its parameters in the order of the document.
    pub rows: Vec<Row>,
    /// The correlations of the last fit: names, and the matrix.
    pub correlation: Option<Correlation>,
    /// Whether it is of a driven axis, whose parameters have names of their own.
    pub of_axis: bool,
}

/// A parameter.
#[derive(Debug, Clone, Deserialize)]
pub struct Row {
    /// Its name, with its place in a list and its direction, as in `sigma0[2].forward`.
    #[serde(skip)]
    pub name: String,
    /// The estimate; not a number where there is none.
    #[serde(deserialize_with = "number_or_none")]
    pub value: f64,
    /// \[its unit\]
    pub unit: String,
    /// None where it was not estimated.
    pub standard_error: Option<f64>,
    /// Ends of the 95 % interval; one that is open is none.
    pub interval_95: Option<[Option<f64>; 2]>,
    /// Whether the recordings tell it.
    pub identified: bool,
}

impl Row {
    /// Both ends of the 95 % interval, where both are there and the value lies between them.
    #[must_use]
    pub fn interval(&self) -> Option<[f64; 2]> {
        let [low, high] = self.interval_95?;
        let ends = [low?, high?];
        (ends[0] <= self.value && self.value <= ends[1]).then_some(ends)
    }
}

/// A number; null is none.
fn number_or_none<'de, D: serde::Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::NAN))
}

/// Correlations of parameters.
#[derive(Debug, Clone, Deserialize)]
pub struct Correlation {
    /// Which.
    pub names: Vec<String>,
    /// Between -1 and 1; null where one was not determined.
    pub matrix: Vec<Vec<Option<f64>>>,
}

#[derive(Deserialize)]
struct Document {
    format: String,
    /// Of a driven axis.
    symmetric: Option<Model>,
    #[serde(default)]
    speeds: Option<[f64; 2]>,
    #[serde(default)]
    models: Map<String, Value>,
    ranking: Option<Ranking>,
}

#[derive(Deserialize)]
struct Ranking {
    chosen: Option<ModelName>,
}

#[derive(Deserialize)]
struct Model {
    parameters: Map<String, Value>,
    correlation: Option<Correlation>,
}

impl Report {
    /// Reads a document, which is called `name`.
    ///
    /// # Errors
    /// [`BadInput`] for what is no identification of friction models.
    pub fn read(name: &str, text: &str) -> Result<Self, BadInput> {
        let wrong = |why: &dyn std::fmt::Display| BadInput(format!("{name}: {why}"));
        let document: Document = serde_json::from_str(text).map_err(|error| {
            wrong(&format!("expected the identification.json of `identify`: {error}"))
        })?;
        match (document.format.as_str(), document.symmetric) {
            ("frictionlab-friction-identification", _) => {}
            ("frictionlab-identification", Some(axis)) => {
                let axis = Reported::of_axis(axis).map_err(|error| wrong(&error))?;
                let speeds = document.speeds;
                return Ok(Self {
                    name: name.to_owned(),
                    speeds,
                    models: vec![axis],
                    chosen: None,
                });
            }
            (of, _) => {
                return Err(wrong(&format!(
                    "expected an identification of friction or of an axis, but its format is `{of}`; `frictionlab identify` makes one"
                )));
            }
        }
        let models = document.models.into_iter().map(|(model, tree)| {
            let model = model_name(&model).map_err(|error| wrong(&error))?;
            let read: Model = serde_json::from_value(tree).map_err(|error| wrong(&error))?;
            let rows = read.parameters.into_iter().map(|(name, row)| {
                let row: Row = serde_json::from_value(row).map_err(|error| wrong(&error))?;
                Ok(Row { name, ..row })
            });
            let rows: Vec<Row> = rows.collect::<Result<_, BadInput>>()?;
            Ok(Reported { model, rows, correlation: read.correlation, of_axis: false })
        });
        Ok(Self {
            name: name.to_owned(),
            speeds: document.speeds,
            models: models.collect::<Result<_, BadInput>>()?,
            chosen: document.ranking.and_then(|ranking| ranking.chosen),
        })
    }

    /// The model of that name; where none is named, the one to use, and where none is, the first.
    ///
    /// # Errors
    /// [`BadInput`] where there is none.
    pub fn model(&self, name: Option<ModelName>) -> Result<&Reported, BadInput> {
        let wanted = name.or(self.chosen);
        let found = match wanted {
            Some(name) => self.models.iter().find(|reported| reported.model == name),
            None => self.models.first(),
        };
        found.ok_or_else(|| {
            let known: Vec<_> = self.models.iter().map(|of| of.model.as_str()).collect();
            let wanted = wanted.map_or("no model", ModelName::as_str);
            BadInput(format!(
                "{}: `{wanted}` was not identified; there is {}",
                self.name,
                known.join(", ")
            ))
        })
    }
}

/// A parameter of a driven axis, as its document has it.
#[derive(Deserialize)]
struct AxisRow {
    #[serde(deserialize_with = "number_or_none")]
    value: f64,
    unit: String,
    standard_error: Option<f64>,
    half_width_95: Option<f64>,
    identifiable: bool,
}

impl Reported {
    /// The model of a driven axis: its friction is that of Coulomb and viscous friction.
    fn of_axis(read: Model) -> Result<Self, serde_json::Error> {
        let rows = read.parameters.into_iter().map(|(name, row)| {
            let row: AxisRow = serde_json::from_value(row)?;
            let ends = row.half_width_95.map(|half| [row.value - half, row.value + half].map(Some));
            Ok(Row {
                name,
                value: row.value,
                unit: row.unit,
                standard_error: row.standard_error,
                interval_95: ends,
                identified: row.identifiable,
            })
        });
        let rows = rows.collect::<Result<_, serde_json::Error>>()?;
        let model = ModelName::CoulombViscous;
        Ok(Self { model, rows, correlation: read.correlation, of_axis: true })
    }

    /// What the model calls a parameter of the document; none for one that is not its own.
    fn own_name<'a>(&self, name: &'a str) -> Option<&'a str> {
        match name {
            _ if !self.of_axis => Some(name),
            "coulomb" => Some("f_c"),
            "viscous" => Some("f_v"),
            _ => None,
        }
    }

    /// The row of that name.
    #[must_use]
    pub fn row(&self, name: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.name == name)
    }

    /// The model with these values in the order of the rows; what the document does not tell is that
    /// of the test bed. Shares of elements are made to sum to one.
    ///
    /// # Errors
    /// Why the model does not take them.
    pub fn with(&self, values: &[f64]) -> Result<AnyModel, String> {
        let two = self.rows.iter().any(|row| row.name.ends_with(".forward"));
        let sides: &[&str] = if two { &["forward", "backward"] } else { &[""] };
        let name = self.model.as_str();
        let mut trees = Map::new();
        for side in sides {
            let preset = serde_json::to_value(AnyParameters::test_bed(self.model));
            let preset = preset.map_err(|error| error.to_string())?;
            let Some(Value::Object(mut tree)) = preset.get(name).cloned() else {
                return Err(format!("{name} has no parameters"));
            };
            self.fill(&mut tree, side, values);
            trees.insert((*side).to_owned(), Value::Object(tree));
        }
        let tree = match trees.remove("") {
            Some(tree) => json!({ name: tree }),
            None => json!({ "asymmetric": { name: trees } }),
        };
        serde_json::from_value(tree).map_err(|error| error.to_string())
    }

    /// Puts the values of one direction into the parameters of a model.
    fn fill(&self, tree: &mut Map<String, Value>, side: &str, values: &[f64]) {
        let mut begun: Vec<&str> = Vec::new();
        for (row, value) in self.rows.iter().zip(values) {
            let Some(name) = self.own_name(&row.name) else { continue };
            let (full, of) = name.split_once('.').unwrap_or((name, side));
            let (plain, place) =
                full.split_once('[').map_or((full, false), |(name, _)| (name, true));
            let known = tree.contains_key(plain)
                || AnyParameters::test_bed(self.model).table().iter().any(|row| row.name == plain);
            if of != side || !known {
                continue;
            }
            if !place {
                // Counts are whole numbers.
                let counts = tree.get(plain).is_some_and(Value::is_u64);
                let number = if counts { json!(value.round() as u64) } else { json!(value) };
                tree.insert(plain.to_owned(), number);
                continue;
            }
            let list = tree.entry(plain).or_insert_with(|| Value::Array(Vec::new()));
            if let Value::Array(list) = list {
                if !begun.contains(&plain) {
                    begun.push(plain);
                    list.clear();
                }
                list.push((*value).into());
            }
        }
        for shares in ["alpha", "lambda"] {
            let Some(Value::Array(list)) = tree.get_mut(shares) else { continue };
            let sum: f64 = list.iter().filter_map(Value::as_f64).sum();
            for share in list.iter_mut() {
                *share = (share.as_f64().unwrap_or(f64::NAN) / sum).into();
            }
        }
    }
}
