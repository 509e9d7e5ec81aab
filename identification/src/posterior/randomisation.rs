//! Samples as tables: CSV, and event terms that give every environment of a simulator a joint set of
//! its own, so that what belongs together stays together. Ranges of each parameter alone, which
//! simulators usually draw from, would lose that: the levels and the viscous coefficient of a fit are
//! strongly correlated.

use strum::Display;
use work::BadInput;

use super::samples::Samples;

/// What a table is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Display, clap::ValueEnum)]
#[strum(serialize_all = "kebab-case")]
#[value(rename_all = "kebab-case")]
pub enum Table {
    /// A column a parameter, a row a sample.
    Csv,
    /// An event term of mjlab: friction loss and damping of a joint.
    Mjlab,
    /// An event term of Isaac Lab: static, dynamic and viscous friction of a joint, as Isaac Sim has
    /// them from 5.0 on.
    IsaacLab,
}

/// The table of these samples; `source` says what they were drawn from, `joint` names it in the
/// simulator.
///
/// # Errors
/// [`BadInput`] where the model has no levels that the simulator takes.
pub fn table(samples: &Samples, of: Table, source: &str, joint: &str) -> Result<String, BadInput> {
    match of {
        Table::Csv => Ok(csv(samples)),
        Table::Mjlab => {
            let rows = rows(samples, of, &[COULOMB, VISCOUS])?;
            Ok(python(
                samples,
                source,
                joint,
                "friction loss [N m], damping [N m s/rad]",
                &rows,
                MJLAB,
            ))
        }
        Table::IsaacLab => {
            let rows = rows(samples, of, &[&["f_s", "f_c", "coulomb"], COULOMB, VISCOUS])?;
            let what = "static and dynamic friction [N m], viscous friction [N m s/rad]";
            Ok(python(samples, source, joint, what, &rows, ISAAC_LAB))
        }
    }
}

/// Names that these friction models and axes have for them.
const COULOMB: &[&str] = &["f_c", "coulomb"];
const VISCOUS: &[&str] = &["f_v", "viscous"];

fn csv(samples: &Samples) -> String {
    let mut text = samples.names.join(",") + "\n";
    for row in &samples.rows {
        let cells: Vec<_> = row.iter().map(|value| format!("{value:?}")).collect();
        text += &cells.join(",");
        text.push('\n');
    }
    text
}

/// The columns that a simulator takes, each by the first of its names that the model has.
fn rows(samples: &Samples, of: Table, columns: &[&[&str]]) -> Result<Vec<Vec<f64>>, BadInput> {
    let place = |names: &&[&str]| {
        let at = |name: &&str| samples.names.iter().position(|known| known == name);
        names.iter().find_map(at).ok_or_else(|| {
            let what = names.join(" or ");
            BadInput(format!(
                "{of} takes Coulomb and viscous friction, but {} has no {what} for both directions",
                samples.model
            ))
        })
    };
    let places: Vec<usize> = columns.iter().map(place).collect::<Result<_, _>>()?;
    let row = |row: &Vec<f64>| places.iter().map(|at| row[*at]).collect();
    Ok(samples.rows.iter().map(row).collect())
}

fn python(
    samples: &Samples,
    source: &str,
    joint: &str,
    what: &str,
    rows: &[Vec<f64>],
    template: &str,
) -> String {
    let plain = |c: char| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let name: String = joint.chars().map(plain).collect();
    let row = |row: &Vec<f64>| {
        let cells: Vec<_> = row.iter().map(|value| format!("{value:?}")).collect();
        format!("    ({}),\n", cells.join(", "))
    };
    let table: String = rows.iter().map(row).collect();
    let mut head = format!(
        "# {} joint samples of {} from {}, written by frictionlab {}.\n# Columns: {what}.\n",
        rows.len(),
        samples.model.title(),
        source.replace(['\n', '\r'], " "),
        env!("CARGO_PKG_VERSION"),
    );
    for note in &samples.notes {
        head += &format!("# {note}\n");
    }
    let joint = format!("{joint:?}");
    let body = template
        .replace("{NAME}", &name.to_uppercase())
        .replace("{name}", &name)
        .replace("{JOINT}", &joint)
        .replace("{ROWS}", table.trim_end_matches('\n'));
    head + &body
}

const MJLAB: &str = r#"# Put {name}_friction_event into the events of the environment's configuration.
import torch
from mjlab.managers.event_manager import EventTermCfg, requires_model_fields
from mjlab.managers.scene_entity_config import SceneEntityCfg

{NAME}_FRICTION = (
{ROWS}
)


@requires_model_fields("dof_frictionloss", "dof_damping")
def randomize_{name}_friction(env, env_ids, asset_cfg=SceneEntityCfg("robot", joint_names=({JOINT},))):
    """Give each environment one of the joint samples."""
    asset = env.scene[asset_cfg.name]
    ids, _ = asset.find_joints(asset_cfg.joint_names)
    places = asset.indexing.joint_v_adr[ids]
    if env_ids is None:
        env_ids = torch.arange(env.num_envs, device=env.device)
    table = torch.tensor({NAME}_FRICTION, device=env.device)
    drawn = table[torch.randint(len(table), (len(env_ids),), device=env.device)]
    env.sim.model.dof_frictionloss[env_ids[:, None], places] = drawn[:, :1]
    env.sim.model.dof_damping[env_ids[:, None], places] = drawn[:, 1:]


{name}_friction_event = EventTermCfg(func=randomize_{name}_friction, mode="reset")
"#;

const ISAAC_LAB: &str = r#"# Put {name}_friction_event into the EventCfg of the environment.
import torch
from isaaclab.managers import EventTermCfg, SceneEntityCfg

{NAME}_FRICTION = (
{ROWS}
)


def randomize_{name}_friction(env, env_ids, asset_cfg):
    """Give each environment one of the joint samples."""
    asset = env.scene[asset_cfg.name]
    if env_ids is None:
        env_ids = torch.arange(env.scene.num_envs, device=asset.device)
    table = torch.tensor({NAME}_FRICTION, device=asset.device)
    drawn = table[torch.randint(len(table), (len(env_ids),), device=asset.device)]
    ids, _ = asset.find_joints(asset_cfg.joint_names)
    static, dynamic, viscous = (column[:, None].expand(-1, len(ids)) for column in drawn.unbind(1))
    asset.write_joint_friction_coefficient_to_sim(static, dynamic, viscous, joint_ids=ids, env_ids=env_ids)


{name}_friction_event = EventTermCfg(
    func=randomize_{name}_friction,
    mode="reset",
    params={"asset_cfg": SceneEntityCfg("robot", joint_names=[{JOINT}])},
)
"#;
