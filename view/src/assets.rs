//! The page, as it is built from `web/` and committed.

/// A file of the page.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asset {
    /// Its path on the server.
    pub(crate) path: &'static str,
    /// What it is, for the browser.
    pub(crate) kind: &'static str,
    pub(crate) bytes: &'static [u8],
}

/// All files of the page.
pub(crate) const ASSETS: [Asset; 4] = [
    Asset {
        path: "/",
        kind: "text/html; charset=utf-8",
        bytes: include_bytes!("../../web/dist/index.html"),
    },
    Asset {
        path: "/app.js",
        kind: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../web/dist/app.js"),
    },
    Asset {
        path: "/app.css",
        kind: "text/css; charset=utf-8",
        bytes: include_bytes!("../../web/dist/app.css"),
    },
    Asset {
        path: "/icon.svg",
        kind: "image/svg+xml",
        bytes: include_bytes!("../../web/dist/icon.svg"),
    },
];

/// The file at a path.
pub(crate) fn find(path: &str) -> Option<&'static Asset> {
    ASSETS.iter().find(|asset| asset.path == path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_nothing_inline_and_nothing_from_elsewhere() {
        let page = std::str::from_utf8(find("/").unwrap().bytes).unwrap();
        for forbidden in ["http://", "https://", "<style", " style=", " onclick=", "<script>"] {
            assert!(!page.contains(forbidden), "{forbidden}");
        }
        assert!(find("/../Cargo.toml").is_none());
    }
}
