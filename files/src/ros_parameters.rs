//! One section of a ROS 2 parameter file.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::DeserializeOwned;

/// The parameters of `/rig_driver` that stand under `section`; `who` writes such a file.
///
/// # Errors
/// A sentence about what is wrong in the text.
pub fn of_rig_driver<T: DeserializeOwned>(
    text: &str,
    section: &str,
    who: &str,
) -> Result<T, String> {
    #[derive(Deserialize)]
    struct Node {
        #[serde(rename = "ros__parameters")]
        parameters: serde_json::Value,
    }
    let tree: BTreeMap<String, Node> = serde_saphyr::from_str(text)
        .map_err(|e| format!("{e}\n(expected `/NODE:` and under it `ros__parameters:`)"))?;
    let node = tree
        .iter()
        .find(|(name, _)| name.trim_start_matches('/') == "rig_driver")
        .map(|(_, node)| &node.parameters)
        .ok_or_else(|| format!("there is no node `rig_driver` in it; {who}"))?;
    let found =
        node.get(section).ok_or_else(|| format!("`rig_driver` has no `{section}` in it"))?;
    serde_json::from_value(found.clone()).map_err(|e| format!("in `{section}`: {e}"))
}
