//! Pictures of whole pages, held against those in the repository.
//!
//! A picture must look alike on every machine, whatever fonts it has: each letter is the same box
//! (`tests/pictures/boxes.py` makes that font). What remains are places, sizes, colours and curves.
//! Pictures are kept at half size, without loss. Two are alike where in every square of 16 by 16
//! pixels of that size the mean difference is at most [`TOLERANCE`]: smoothed edges may differ
//! between versions of a browser, a curve of another colour or a table that is cut may not.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::tab::Tab;

/// Most that a square may differ, of 255.
pub const TOLERANCE: f64 = 8.0;

const COMPARE: &str = include_str!("../browser/compare.js");
const FONT: &[u8] = include_bytes!("../pictures/boxes.woff2");

/// Set: the pictures in the repository are written anew.
const UPDATE: &str = "UPDATE_PICTURES";

/// A page with boxes in place of letters, in `file`.
///
/// # Panics
/// When it cannot be written, or has no policy to be replaced.
pub fn boxed(html: &str, file: &Path) {
    let (before, rest) =
        html.split_once("<meta http-equiv=\"Content-Security-Policy\"").expect("a page's policy");
    let (_, after) = rest.split_once('>').expect("a whole element");
    let font = crate::tab::to_base64(FONT);
    // Nothing moves in a picture, and the pointer is nowhere.
    let style = format!(
        "<style>@font-face {{ font-family: Boxes; src: url(data:font/woff2;base64,{font}) }}
         * {{ font-family: Boxes !important; transition: none !important; scrollbar-width: none }}</style>"
    );
    fs::write(file, format!("{before}{style}{after}")).expect("the copy is written");
}

/// An expression: a promise of true, once the letters are boxes and the figures are drawn with them.
pub const SETTLED: &str = "(async () => {
    await Promise.all(['400', '600', '650'].map((weight) => document.fonts.load(`${weight} 16px Boxes`)));
    await document.fonts.ready;
    const figures = [...document.querySelectorAll('.plot')];
    
    for (const figure of figures) await Plotly.redraw(figure);
    return true;
})()";

/// What differs between two pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Width and height of the one seen and of the one expected, in pixels.
    pub sizes: [[u64; 2]; 2],
    /// The difference in the square that differs most, of 255.
    pub worst: f64,
    /// Its left and upper edge in pixels.
    pub at: [u64; 2],
    /// Squares beyond the tolerance.
    pub squares: usize,
}

impl Difference {
    /// Whether they are alike.
    #[must_use]
    pub fn is_small(&self) -> bool {
        self.sizes[0] == self.sizes[1] && self.worst <= TOLERANCE
    }
}

/// Compares two pictures (WebP) in `tab`.
///
/// # Panics
/// When one is no picture.
pub fn compare(tab: &mut Tab, seen: &[u8], expected: &[u8]) -> Difference {
    let url = |picture: &[u8]| format!("data:image/webp;base64,{}", crate::tab::to_base64(picture));
    let found = tab.evaluate(&format!(
        "(async (seenUrl, expectedUrl, tolerance) => {{ {COMPARE} }})({}, {}, {TOLERANCE})",
        json!(url(seen)),
        json!(url(expected))
    ));
    let pair = |value: &Value| [0, 1].map(|at| value[at].as_u64().expect("a number"));
    Difference {
        sizes: [pair(&found["seen"]), pair(&found["expected"])],
        worst: found["worst"].as_f64().expect("a number"),
        at: pair(&found["at"]),
        squares: found["squares"].as_array().map_or(0, Vec::len),
    }
}

/// Holds the whole page that `tab` shows against `tests/pictures/NAME.webp`, which is written anew
/// with `UPDATE_PICTURES=1`. Returns what is wrong, with a page that shows both.
pub fn complaint(tab: &mut Tab, name: &str) -> Option<String> {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("pictures").join(format!("{name}.webp"));
    let seen = tab.whole_picture(0.5);
    if std::env::var_os(UPDATE).is_some() {
        // One that is alike stays: no change in the repository without a change to be seen.
        let alike = |expected: Vec<u8>| compare(tab, &seen, &expected).is_small();
        if !fs::read(&kept).is_ok_and(alike) {
            fs::write(&kept, &seen).expect("the picture is written");
        }
        return None;
    }
    let Ok(expected) = fs::read(&kept) else {
        return Some(format!("{} is not there: run the test with {UPDATE}=1", kept.display()));
    };
    let found = compare(tab, &seen, &expected);
    if found.is_small() {
        return None;
    }
    let page = shown(name, &seen, &expected, &found);
    Some(format!(
        "{name}: {found:?} where {TOLERANCE} of 255 are allowed; look at {}, then run the test with {UPDATE}=1 if it is meant",
        page.display()
    ))
}

/// A page with what was seen, what was expected, and the difference of both.
fn shown(name: &str, seen: &[u8], expected: &[u8], found: &Difference) -> PathBuf {
    let folder = crate::target_folder().join("pictures");
    fs::create_dir_all(&folder).expect("a folder in the target folder");
    let file = |what: &str| format!("{name}_{what}.webp");
    for (what, picture) in [("seen", seen), ("expected", expected)] {
        fs::write(folder.join(file(what)), picture).expect("the picture is written");
    }
    let html = format!(
        "<!doctype html><title>{name}</title><p>{found:?}</p><style>img {{ vertical-align: top }} .both {{ display: inline-block; position: relative }}
         .both img + img {{ position: absolute; left: 0; mix-blend-mode: difference }}</style>
         <p>seen, expected, difference</p><img src='{0}'> <img src='{1}'> <span class='both'><img src='{0}'><img src='{1}'></span>",
        file("seen"),
        file("expected")
    );
    let page = folder.join(format!("{name}.html"));
    fs::write(&page, html).expect("the page is written");
    page
}

/// How many pixels there are of each hue (in twelfths of the circle) that is strong, in the middle
/// of a picture (PNG), away from the frames that programs put around what they show.
///
/// # Panics
/// When it is no picture.
pub fn strong_colours(tab: &mut Tab, png: &Path) -> std::collections::BTreeMap<u8, u64> {
    let picture = fs::read(png).expect("a picture");
    let url = format!("data:image/png;base64,{}", crate::tab::to_base64(&picture));
    let counts = tab.evaluate(&format!(
        "(async (url) => {{
            const picture = new Image(); picture.src = url; await picture.decode();
            const canvas = new OffscreenCanvas(picture.naturalWidth, picture.naturalHeight);
            const context = canvas.getContext('2d'); context.drawImage(picture, 0, 0);
            const [left, top] = [Math.round(0.17 * canvas.width), Math.round(0.08 * canvas.height)];
            const {{ data }} = context.getImageData(left, top, Math.round(0.6 * canvas.width), Math.round(0.6 * canvas.height));
            const counts = Array(12).fill(0);
            for (let at = 0; at < data.length; at += 4) {{
                const [r, g, b] = [data[at], data[at + 1], data[at + 2]], most = Math.max(r, g, b), least = Math.min(r, g, b);
                if (most - least < 70) continue;
                const hue = most === r ? (g - b) / (most - least) : most === g ? 2 + (b - r) / (most - least) : 4 + (r - g) / (most - least);
                counts[Math.floor(2 * ((hue + 6) % 6)) % 12]++;
            }}
            return counts; }})({})",
        json!(url)
    ));
    let counts = counts.as_array().into_iter().flatten().filter_map(Value::as_u64);
    let few = 100;
    (0..).zip(counts).filter(|(_, count)| *count > few).collect()
}
