//! What a check found, and the report that all checks make.

use serde::Serialize;

/// How well a thing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing to do.
    Fine,
    /// Works, but could be better, or was not what is usual.
    LookAtThis,
    /// The laboratory does not work with this.
    Broken,
}

impl Verdict {
    /// As people read it.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Fine => "fine",
            Self::LookAtThis => "look at this",
            Self::Broken => "BROKEN",
        }
    }
}

/// A number with its unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// What it is.
    pub name: String,
    /// The number.
    pub value: f64,
    /// Its unit, as in `us`; empty for a count.
    pub unit: &'static str,
}

/// One thing that was looked at.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What was looked at.
    pub subject: String,
    /// How it is.
    pub verdict: Verdict,
    /// What was found, a sentence.
    pub found: String,
    /// What was found, in figures.
    pub figures: Vec<Figure>,
    /// How to mend it, unless it is fine.
    pub mend: Option<String>,
}

impl Finding {
    /// All is well.
    #[must_use]
    pub fn fine(subject: impl Into<String>, found: impl Into<String>) -> Self {
        Self {
            subject: subject.into(),
            verdict: Verdict::Fine,
            found: found.into(),
            figures: Vec::new(),
            mend: None,
        }
    }

    /// Somebody should look.
    #[must_use]
    pub fn look(
        subject: impl Into<String>,
        found: impl Into<String>,
        mend: impl Into<String>,
    ) -> Self {
        Self { verdict: Verdict::LookAtThis, mend: Some(mend.into()), ..Self::fine(subject, found) }
    }

    /// It does not work.
    #[must_use]
    pub fn broken(
        subject: impl Into<String>,
        found: impl Into<String>,
        mend: impl Into<String>,
    ) -> Self {
        Self { verdict: Verdict::Broken, mend: Some(mend.into()), ..Self::fine(subject, found) }
    }

    /// The same with one more figure.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, value: f64, unit: &'static str) -> Self {
        self.figures.push(Figure { name: name.into(), value, unit });
        self
    }
}

/// What belongs together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Section {
    /// Its name.
    pub name: &'static str,
    /// What was found.
    pub findings: Vec<Finding>,
}

/// Everything that was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The worst verdict.
    pub verdict: Verdict,
    /// The sections in their order.
    pub sections: Vec<Section>,
}

impl Report {
    /// Of these sections.
    #[must_use]
    pub fn new(sections: Vec<Section>) -> Self {
        let verdicts =
            sections.iter().flat_map(|section| &section.findings).map(|finding| finding.verdict);
        Self { verdict: verdicts.max().unwrap_or(Verdict::Fine), sections }
    }

    /// Every finding with that verdict.
    pub fn of(&self, verdict: Verdict) -> impl Iterator<Item = &Finding> {
        self.sections
            .iter()
            .flat_map(|section| &section.findings)
            .filter(move |finding| finding.verdict == verdict)
    }
}
