//! Files that are shown beside the page: `/files/KEY/FOLDER/NAME`.
//!
//! A report is a page of its own, with scripts, and a folder of results may come from anywhere. The
//! browser gives it an origin of its own (`sandbox`), so that it is no part of the page that
//! steers: it opens no socket, reads nothing from here, and sends nothing anywhere.

use crate::shared::Shared;

/// What a file that is shown may do.
pub(crate) const POLICY: &str = "sandbox allow-scripts allow-downloads; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Longest name of a file \[bytes\].
const NAME: usize = 100;

/// The number of a folder and the name of a file in it, by a path whose key is right.
pub(crate) fn asked<'a>(path: &'a str, shared: &Shared) -> Option<(u32, &'a str)> {
    parts(path, |key| shared.key.is(key))
}

fn parts(path: &str, is_key: impl Fn(&str) -> bool) -> Option<(u32, &str)> {
    let mut parts = path.strip_prefix("/files/")?.split('/');
    let (key, folder, name) = (parts.next()?, parts.next()?, parts.next()?);
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "._-".contains(letter);
    let is_name = name.len() <= NAME && !name.starts_with('.') && name.chars().all(plain);
    let is_number = !folder.is_empty() && folder.bytes().all(|digit| digit.is_ascii_digit());
    let good = is_key(key) && is_number && is_name && !name.is_empty() && parts.next().is_none();
    good.then(|| Some((folder.parse().ok()?, name))).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_number_and_a_plain_name_behind_the_key_are_a_file() {
        let of = |path| parts(path, |key| key == "k");
        assert_eq!(of("/files/k/3/report.html"), Some((3, "report.html")));
        for wrong in [
            "/files/k/3/",
            "/files/k/3",
            "/files/k//report.html",
            "/files/x/3/report.html",
            "/files/k/+3/report.html",
            "/files/k/99999999999/report.html",
            "/files/k/3/../report.html",
            "/files/k/3/..",
            "/files/k/3/.hidden",
            "/files/k/3/%2e%2e",
            "/files/k/3/a/b",
            "/files/k/../report.html",
            "/files/k/3/a\\b",
            "/files",
        ] {
            assert_eq!(of(wrong), None, "{wrong}");
        }
    }
}
