//! `--joint a,b,c` or `--joint all`: each joint is identified by itself.

use recording::joints::JointChoice;
use recording::overview;
use recording::table::Measured;
use work::BadInput;

use super::IdentifyArgs;

impl IdentifyArgs {
    /// The joints that are meant; none where none was named, and where the file as a whole is what
    /// `all` means: it names no joints.
    ///
    /// # Errors
    /// [`BadInput`] or [`RecordingError`](recording::RecordingError) where the first file does not hold
    /// them.
    pub fn joints(&self) -> anyhow::Result<Vec<String>> {
        let Some(named) = &self.joint else { return Ok(Vec::new()) };
        let (Some(file), true) = (self.files.first(), named == "all" || named.contains(',')) else {
            return Ok(vec![named.clone()]);
        };
        let columns = self.table.columns(Measured::Force, None);
        let present = overview::look(self.input(file), &columns, &JointChoice::default())?.joints;
        // A joint may be called so.
        if present.contains(named) {
            return Ok(vec![named.clone()]);
        }
        if named == "all" {
            return Ok(present);
        }
        let mut wanted: Vec<String> = Vec::new();
        for joint in named.split(',').map(str::trim) {
            if !present.iter().any(|other| other == joint) {
                let (file, present) = (file.display(), present.join(", "));
                return Err(BadInput(format!(
                    "--joint: {file} holds no joint `{joint}`; its joints are: {present}"
                ))
                .into());
            }
            if !wanted.iter().any(|other| other == joint) {
                wanted.push(joint.to_owned());
            }
        }
        Ok(wanted)
    }
}
