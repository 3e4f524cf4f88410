//! The findings as text.

use std::fmt::Write as _;

use super::{Diagnosis, Finding, Grade};

/// Columns of a terminal.
const TERMINAL: usize = 80;

/// The verdict, the table, and what to do, the worst first.
pub(super) fn text(diagnosis: &Diagnosis) -> String {
    let mut text = String::new();
    let verdict = match diagnosis.count(Grade::Lacks) {
        0 => "nothing is lacking",
        _ => "not ready",
    };
    let _ = writeln!(
        text,
        "{verdict}: ✓ {} ok, ~ {} could be better, ✗ {} lacking, ? {} not known\n",
        diagnosis.count(Grade::Ok),
        diagnosis.count(Grade::CouldBeBetter),
        diagnosis.count(Grade::Lacks),
        diagnosis.count(Grade::NotKnown),
    );
    for line in diagnosis.machine.iter().chain([&diagnosis.kernel]) {
        if !line.is_empty() {
            let _ = writeln!(text, "{line}");
        }
    }
    text.push('\n');
    let findings = &diagnosis.findings;
    let width = findings
        .iter()
        .map(|finding| finding.name.chars().count())
        .max()
        .unwrap_or(0);
    for finding in findings {
        let Finding { name, found, .. } = finding;
        let mark = mark(finding.grade);
        let mut found = found.clone();
        if width + found.chars().count() > TERMINAL - 5 {
            found = found.replace("; ", &format!(";\n{:1$}", "", width + 5));
        }
        let _ = writeln!(text, " {mark} {name:width$}  {found}");
    }
    for (grade, title) in [
        (Grade::Lacks, "Lacking"),
        (Grade::CouldBeBetter, "Could be better"),
        (Grade::Ok, "To make use of it"),
        (Grade::NotKnown, "Not known"),
    ] {
        let mut todo = findings
            .iter()
            .filter(|finding| finding.grade == grade && !is_silent(finding))
            .peekable();
        if todo.peek().is_some() {
            let _ = writeln!(text, "\n{title}:");
        }
        for finding in todo {
            let mut said = format!(" {} {}", mark(grade), finding.name);
            if !finding.why.is_empty() {
                let _ = write!(said, ": {}", finding.why);
            }
            let _ = writeln!(text, "{}", wrapped(&said));
            for remedy in &finding.remedies {
                let _ = writeln!(text, "     {}\n       {}", remedy.place, remedy.line);
            }
        }
    }
    text.truncate(text.trim_end().len());
    text
}

/// A finding in lines of a terminal's width, the others below its name.
fn wrapped(finding: &str) -> String {
    let mut text = String::new();
    let mut column = 0;
    for word in finding.split_inclusive(' ') {
        let width = word.trim_end().chars().count();
        if column + width > TERMINAL {
            text.truncate(text.trim_end().len());
            text.push_str("\n   ");
            column = 3;
        }
        text.push_str(word);
        column += word.chars().count();
    }
    text
}

fn is_silent(finding: &Finding) -> bool {
    finding.why.is_empty() && finding.remedies.is_empty()
}

const fn mark(grade: Grade) -> char {
    match grade {
        Grade::Ok => '✓',
        Grade::CouldBeBetter => '~',
        Grade::Lacks => '✗',
        Grade::NotKnown => '?',
    }
}
