//! What is asked of an export: the options of `frictionlab export` and of `result.export(...)`.

use experiment_runner::models::file;
use friction_model::ModelName;
use recording::AxisKind;
use simulator_export::{
    Axis, Cogging, Exported, Given, Motor, Options, Reference, Speeds, SpeedsFrom, Target, Version,
    Volts,
};
use work::BadInput;
use work::model_name::model_name;

/// The options, but for where the parameters come from and where the file goes.
#[derive(Debug, Clone, clap::Args)]
pub struct ExportOptions {
    /// What the file is for; --list shows all.
    #[arg(long, value_name = "TARGET", value_parser = target, required_unless_present = "list")]
    to: Option<Target>,

    /// Version of the target [default: the newest that is known].
    #[arg(long, value_name = "VERSION", value_parser = version)]
    target_version: Option<Version>,

    /// The model, where the file has several [default: the one that the file chooses].
    #[arg(long, value_name = "NAME", value_parser = model_name)]
    model: Option<ModelName>,

    /// The joint's name in the target.
    #[arg(long, value_name = "NAME", default_value = "joint")]
    joint: String,

    /// Speeds over which the friction was identified [rad/s or m/s]; errors are computed over them
    /// [default: those that the file names].
    #[arg(long, value_name = "LOW:HIGH", value_parser = speeds, allow_negative_numbers = true)]
    speeds: Option<Speeds>,

    /// Whether the joint turns or slides [default: as the file says, else rotary].
    #[arg(long, value_enum)]
    axis: Option<AxisKind>,

    /// Inertia of the rotor at the joint [kg m^2 or kg].
    #[arg(long, value_name = "J", allow_negative_numbers = true)]
    armature: Option<f64>,

    /// Torque that depends on the angle: amplitude [N m], periods a revolution, phase [rad].
    #[arg(long, value_name = "A,N,PHASE", value_parser = cogging, allow_negative_numbers = true)]
    cogging: Option<Cogging>,

    /// Inertia of the whole axis [kg m^2 or kg], for kA.
    #[arg(long, value_name = "J", allow_negative_numbers = true)]
    inertia: Option<f64>,

    /// For gains in volts: volts that hold one N m at the joint (resistance over torque constant),
    /// and volts that one rad/s induces.
    #[arg(long, value_name = "VOLTS[:BACK_EMF]", value_parser = volts, allow_negative_numbers = true)]
    volts_per_newton_metre: Option<Volts>,

    /// Friction that the robot's own model has at scale 1, for `ur`: Coulomb level [N m] and viscous
    /// coefficient [N m s/rad].
    #[arg(long, value_name = "COULOMB:VISCOUS", value_parser = reference, allow_negative_numbers = true)]
    reference: Option<Reference>,

    /// The motor, for `bam`: torque constant [N m/A] and resistance [ohm].
    #[arg(long, value_name = "KT:RESISTANCE", value_parser = motor, allow_negative_numbers = true)]
    motor: Option<Motor>,

    /// What BAM calls the actuator, for `bam`, such as sts3215.
    #[arg(long, value_name = "NAME")]
    actuator: Option<String>,

    /// Write the file although its error is beyond the bar; the file says so.
    #[arg(long)]
    accept_error: bool,

    /// Write the file although nobody identified some of the parameters; the file says so.
    #[arg(long)]
    accept_unidentified: bool,

    /// List the targets with their versions, and what each can hold.
    #[arg(long)]
    pub list: bool,
}

impl ExportOptions {
    /// Writes the friction in a parameter file, whose name and text are given.
    ///
    /// # Errors
    /// [`BadInput`] for a file that holds no friction model, and for what would mislead or has no
    /// place in the target.
    pub fn export(&self, name: &str, text: &str) -> Result<Exported, BadInput> {
        let refused = |what: &dyn ToString| BadInput(format!("{name}: {}", what.to_string()));
        let Some(target) = self.to else {
            return Err(BadInput(format!("--to is missing; expected one of {}", Target::list())));
        };
        if let Some(what) = other_kind(text) {
            return Err(refused(&what));
        }
        let model = file::read(text, self.model).map_err(|error| refused(&error))?;
        let axis = self.axis.map(|axis| match axis {
            AxisKind::Rotary => Axis::Rotary,
            AxisKind::Linear => Axis::Linear,
        });
        let given = Given::new(model, name, text, self.speeds, axis);
        let given = given.map_err(|error| refused(&error))?;
        let options = Options {
            joint: self.joint.clone(),
            armature: self.armature,
            cogging: self.cogging,
            inertia: self.inertia,
            volts: self.volts_per_newton_metre,
            reference: self.reference,
            motor: self.motor,
            actuator: self.actuator.clone(),
            accept_error: self.accept_error,
            accept_unidentified: self.accept_unidentified,
        };
        let exported = simulator_export::export(&given, target, self.target_version, &options);
        exported.map_err(|error| refused(&error))
    }
}

/// What to do with a file that holds no friction model, but something else of this program.
fn other_kind(text: &str) -> Option<&'static str> {
    let tree: serde_json::Value = serde_json::from_str(text).ok()?;
    let format = tree.get("format").and_then(|format| format.as_str()).unwrap_or_default();
    if format.contains("servo") || tree.get("kt").is_some() || tree.get("friction_base").is_some() {
        return Some(
            "these are the parameters of a servo, whose friction depends on its load; no target but BAM holds that, and BAM reads such a file itself. Identify friction with `frictionlab identify` for the others",
        );
    }
    format.starts_with("frictionlab-").then_some(
        "this is a document of results; give the parameters.yaml that was written beside it",
    )
}

fn target(text: &str) -> Result<Target, String> {
    simulator_export::target(text).map_err(|error| error.to_string())
}

fn version(text: &str) -> Result<Version, String> {
    text.parse().map_err(|error: simulator_export::NotAVersion| error.to_string())
}

/// Numbers with a sign between them.
fn numbers<const N: usize>(text: &str, between: char) -> Option<[f64; N]> {
    let parts: Option<Vec<f64>> =
        text.split(between).map(|part| part.trim().parse::<f64>().ok()).collect();
    parts?.try_into().ok()
}

fn speeds(text: &str) -> Result<Speeds, String> {
    let [low, high] = numbers(text, ':').ok_or("expected two speeds, as in 0.05:3")?;
    Speeds::new(low, high, SpeedsFrom::Asked).map_err(|error| error.to_string())
}

fn cogging(text: &str) -> Result<Cogging, String> {
    let [amplitude, periods, phase] =
        numbers(text, ',').ok_or("expected amplitude, periods and phase, as in 0.01,12,0")?;
    Ok(Cogging { amplitude, periods, phase })
}

fn volts(text: &str) -> Result<Volts, String> {
    let [per_effort, back_emf] = numbers(text, ':')
        .or_else(|| numbers(text, ':').map(|[per_effort]| [per_effort, 0.0]))
        .ok_or("expected volts, and after a colon the back-EMF, as in 1.86:0.53")?;
    Ok(Volts { per_effort, back_emf })
}

fn reference(text: &str) -> Result<Reference, String> {
    let [f_c, f_v] = numbers(text, ':')
        .ok_or("expected the Coulomb level and the viscous coefficient, as in 4.5:9")?;
    Ok(Reference { f_c, f_v })
}

fn motor(text: &str) -> Result<Motor, String> {
    let [kt, resistance] =
        numbers(text, ':').ok_or("expected torque constant and resistance, as in 1.2:2.7")?;
    Ok(Motor { kt, resistance })
}

#[cfg(test)]
mod tests {
    use super::*;
    use work::line;

    const FILE: &str = "\
# Friction models fitted by frictionlab 0.1.0 to a.csv.
# Speeds of the recordings: 0.05 to 3.0 rad/s
/friction_observer:
  ros__parameters:
    model: coulomb_viscous
    coulomb_viscous:
      f_c: 0.1  # identified, +- 1e-4
      f_v: 0.04  # identified, +- 1e-4
";

    fn asked(words: &[&str], text: &str) -> Result<Exported, BadInput> {
        let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
        line::parse::<ExportOptions>(&words)?.export("p.yaml", text)
    }

    #[test]
    fn a_file_of_identify_goes_to_a_target() {
        let found = asked(&["--to", "urdf", "--joint", "elbow"], FILE).unwrap();
        assert!(found.text.contains("<dynamics damping=\"0.04"), "{}", found.text);
        assert!(found.text.contains("elbow") && found.text.contains("a.csv"), "{}", found.text);
        let volts =
            asked(&["--to", "ks_kv_ka", "--volts-per-newton-metre", "2:0.5"], FILE).unwrap();
        let tree: serde_json::Value = serde_json::from_str(&volts.text).unwrap();
        assert!((tree["kS"].as_f64().unwrap() - 0.2).abs() < 1e-9, "{tree}");
        assert!((tree["kV"].as_f64().unwrap() - 0.58).abs() < 1e-9, "{tree}");
    }

    #[test]
    fn what_is_wrong_is_said_in_a_sentence() {
        let to = |target: &'static str| vec!["--to", target];
        for (words, text, part) in [
            (to("gazebo_3"), FILE, "expected one of mjcf"),
            ([to("mjcf"), vec!["--target-version", "9"]].concat(), FILE, "2.0 to 4.0"),
            ([to("mjcf"), vec!["--target-version", "x"]].concat(), FILE, "no version"),
            (to("mjcf"), "", "expected parameters under a model's name"),
            (to("mjcf"), "{\"kt\": 1.0, \"friction_base\": 0.1}", "of a servo"),
            (to("mjcf"), "{\"format\": \"frictionlab-x\"}", "parameters.yaml"),
            (to("ur"), FILE, "--reference"),
            (to("bam"), FILE, "--actuator"),
            ([to("isaac_lab"), vec!["--target-version", "2.1"]].concat(), FILE, "coefficient"),
            (to("mjcf"), "coulomb_viscous: {f_c: 0.1, f_v: 0.0}", "never identified"),
            (vec![], FILE, "--to"),
            ([to("urdf"), vec!["--speeds", "3:1"]].concat(), FILE, "LOW to HIGH"),
            ([to("urdf"), vec!["--speeds", "3"]].concat(), FILE, "two speeds"),
            ([to("urdf"), vec!["--joint", "a b"]].concat(), FILE, "letters"),
            ([to("urdf"), vec!["--armature", "1"]].concat(), FILE, "no place"),
            ([to("mjcf"), vec!["--armature", "-1"]].concat(), FILE, "above zero"),
            ([to("urdf"), vec!["--model", "lugre"]].concat(), FILE, "no parameters of `lugre`"),
        ] {
            let said = asked(&words, text).unwrap_err().to_string();
            assert!(said.contains(part) && said.lines().count() == 1, "{words:?}: {said}");
        }
        let volts = format!("# Friction is told in volts: so.\n{FILE}");
        assert!(asked(&to("mjcf"), &volts).unwrap_err().to_string().contains("in volts"));
        assert!(asked(&to("ks_kv_ka"), &volts).unwrap().text.contains("\"kS_unit\": \"V\""));
    }
}
