//! The lines that tell where a view is.

use view::View;

/// Where a view is, in words for people.
#[must_use]
pub fn words(view: &View) -> String {
    match view.urls() {
        (page, None) => format!("view: {page}"),
        (page, Some(read_only)) => {
            format!("view: {page}\nview for those who only look: {read_only}")
        }
    }
}
