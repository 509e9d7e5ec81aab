//! How foreign text gets into the page where the templates' own escaping is not all it takes.

use std::fmt::Write;

use maud::{Markup, PreEscaped, html};

/// Text for reading: escaped, with what stands between two backticks set as code.
pub(super) fn prose(text: &str) -> Markup {
    let parts: Vec<&str> = text.split('`').collect();
    html! {
        @for (index, part) in parts.iter().enumerate() {
            @match (index % 2 == 1, index + 1 < parts.len()) {
                (false, _) => { (breakable(part)) }
                (true, true) => { code { (breakable(part)) } }
                // A single backtick is itself.
                (true, false) => { "`" (part) }
            }
        }
    }
}

/// Characters of a word that is given places at which a line may end.
const LONG_WORD: usize = 28;

/// Text whose long words, as `gravity+bristle+viscous+asymmetric`, may go on in the next line behind
/// each plus rather than within a part.
fn breakable(text: &str) -> Markup {
    html! {
        @for word in text.split_inclusive(char::is_whitespace) {
            @if word.contains('+') && word.chars().count() > LONG_WORD {
                @for (index, part) in word.split_inclusive('+').enumerate() {
                    @if index > 0 { wbr; }
                    (part)
                }
            } @else { (word) }
        }
    }
}

/// JSON as it may stand inside a `<script>` element.
///
/// In JSON these characters can only occur within strings, where the escape means the same; without
/// it a `</script>` or `<!--` in somebody's label would end or swallow the element.
pub(super) fn json_element(json: &str) -> PreEscaped<String> {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => {
                // Writing to a String cannot fail.
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    PreEscaped(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_name_ends_a_line_behind_a_plus() {
        let name = "gravity+bristle+viscous+asymmetric";
        let broken = "gravity+<wbr>bristle+<wbr>viscous+<wbr>asymmetric";
        assert_eq!(prose(name).0, broken);
        assert_eq!(
            prose(&format!("take `{name}` (1e+5)")).0,
            format!("take <code>{broken}</code> (1e+5)")
        );
        assert_eq!(prose("bristle+viscous").0, "bristle+viscous");
    }

    #[test]
    fn markup_becomes_text() {
        assert_eq!(
            prose(r#"<b a='1' c="2">&amp;"#).0,
            "&lt;b a='1' c=&quot;2&quot;&gt;&amp;amp;",
            "attributes stand in double quotes, so single ones may stay"
        );
    }

    #[test]
    fn backticks_become_code() {
        assert_eq!(prose("run `a <b>` or `c`").0, "run <code>a &lt;b&gt;</code> or <code>c</code>");
        assert_eq!(prose("a ` alone").0, "a ` alone");
        assert_eq!(prose("`whole`").0, "<code>whole</code>");
    }

    #[test]
    fn json_cannot_close_its_element_and_keeps_its_meaning() {
        let nasty = "</script><!-- <b>&\u{2028}";
        let json = serde_json::to_string(nasty).unwrap();
        let safe = json_element(&json).0;
        assert!(!safe.contains(['<', '>', '&', '\u{2028}']));
        assert_eq!(serde_json::from_str::<String>(&safe).unwrap(), nasty);
    }
}
