//! What a file holds and what can be identified from it, before any fit: in the terminal, as JSON
//! and as a page with pictures.

mod page;
mod prospects;
mod servo;
mod terminal;

use recording::overview::Overview;
use serde::Serialize;

pub use page::page;
pub use prospects::{Prospects, prospects};
pub use servo::{ServoLook, servo};
pub use terminal::terminal;

/// The document of `--json` and `look.json`.
///
/// # Errors
/// If it cannot be said in JSON, a mistake of this program.
pub fn document(seen: &Overview) -> anyhow::Result<String> {
    #[derive(Serialize)]
    struct Document<'a> {
        #[serde(flatten)]
        seen: &'a Overview,
        prospects: Prospects,
    }
    work::saying::document(&Document { seen, prospects: prospects(seen) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use recording::joints::JointChoice;
    use recording::overview;
    use recording::table::Columns;

    fn looked(text: &str) -> Overview {
        let file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
        std::fs::write(file.path(), text).unwrap();
        overview::look(file.path(), &Columns::default(), &JointChoice::default()).unwrap()
    }

    #[test]
    fn what_can_be_identified_and_what_is_missing_is_said() {
        let mut one_way = "t_s,position_rad,i\n".to_owned();
        for k in 0..300 {
            one_way += &format!("{},{},{}\n", f64::from(k) * 1e-3, 0.01 * f64::from(k), 0.5);
        }
        let seen = looked(&one_way);
        let found = prospects(&seen);
        assert!(found.can.iter().any(|can| can.contains("--force-column 'i:KT'")), "{found:?}");
        assert!(found.missing.iter().any(|what| what.contains("one direction")), "{found:?}");
        let text = terminal(&seen);
        for part in ["position_rad", "1000 Hz", "300 samples", "one direction"] {
            assert!(text.contains(part), "{text}");
        }
        assert!(document(&seen).unwrap().contains("\"prospects\""));
        let found = prospects(&looked("velocity_rad_s,torque_Nm\n1,2\n2,3\n"));
        assert!(found.can[0].contains("steady points"), "{found:?}");
        let found = prospects(&looked("t_s,position_rad\n0,2\n2,3\n"));
        assert!(found.can.is_empty() && found.missing[0].contains("--force-column"), "{found:?}");
    }
}
