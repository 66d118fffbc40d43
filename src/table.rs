//! A CSV with named columns, whose errors name file, line and column.
//!
//! One record a line, fields between commas, blanks around them ignored, quotes as in RFC 4180
//! but no line breaks within them. Blank lines are skipped, and comments where the format has
//! them.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Why a table cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", file.display())]
    Read {
        /// The CSV.
        file: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Something is wrong at a line.
    #[error("{}:{line}: {text}", file.display())]
    Line {
        /// The CSV.
        file: PathBuf,
        /// Line, from 1.
        line: u64,
        /// What is wrong and what is allowed.
        text: String,
    },
}

/// A CSV in memory: its header, and the text of its rows.
#[derive(Debug)]
pub(crate) struct Table {
    file: PathBuf,
    text: String,
    comment: Option<char>,
    header: Vec<String>,
    header_line: u64,
}

/// One record.
#[derive(Debug)]
pub(crate) struct Row<'table> {
    table: &'table Table,
    line: u64,
    fields: Vec<String>,
}

impl Table {
    /// Reads `file`; `comment` starts a comment that reaches to the end of its line.
    pub(crate) fn read(file: &Path, comment: Option<char>) -> Result<Self, TableError> {
        let bytes =
            fs::read(file).map_err(|source| TableError::Read { file: file.into(), source })?;
        Self::parse(bytes, file, comment)
    }

    /// The table in `bytes`; `file` is what errors name.
    pub(crate) fn parse(
        bytes: Vec<u8>,
        file: &Path,
        comment: Option<char>,
    ) -> Result<Self, TableError> {
        let text = String::from_utf8(bytes).map_err(|error| {
            let before = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count() as u64;
            TableError::Line { file: file.into(), line, text: "not UTF-8".into() }
        })?;
        let mut table =
            Self { file: file.into(), text, comment, header: Vec::new(), header_line: 1 };
        let Some((line, text)) = table.lines().next() else {
            return Err(table.at(1, "the file is empty; allowed: a header and rows"));
        };
        table.header = split(text).map_err(|what| table.at(line, what))?;
        table.header_line = line;
        for (index, name) in table.header.iter().enumerate() {
            if name.is_empty() {
                return Err(table.at(line, format!("column {} has no name", index + 1)));
            }
            if table.header[..index].contains(name) {
                return Err(table.at(line, format!("column `{name}` appears twice")));
            }
        }
        Ok(table)
    }

    /// An error at a line of this file.
    pub(crate) fn at(&self, line: u64, text: impl Into<String>) -> TableError {
        TableError::Line { file: self.file.clone(), line, text: text.into() }
    }

    /// An error in the header.
    pub(crate) fn in_header(&self, text: impl Into<String>) -> TableError {
        self.at(self.header_line, text)
    }

    /// Names of the columns.
    pub(crate) fn header(&self) -> &[String] {
        &self.header
    }

    /// Index of a column that may be missing.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|column| column == name)
    }

    /// Index of a column that must be there.
    pub(crate) fn require(&self, name: &str) -> Result<usize, TableError> {
        self.column(name).ok_or_else(|| {
            let known = self.header.join("`, `");
            self.in_header(format!("column `{name}` is missing; the header has `{known}`"))
        })
    }

    /// The records, in the order of the file.
    pub(crate) fn rows(&self) -> impl Iterator<Item = Result<Row<'_>, TableError>> {
        self.lines().skip(1).map(|(line, text)| {
            let fields = split(text).map_err(|what| self.at(line, what))?;
            if fields.len() != self.header.len() {
                let (found, expected) = (fields.len(), self.header.len());
                let text = format!("{found} fields; allowed: {expected}, as in the header");
                return Err(self.at(line, text));
            }
            Ok(Row { table: self, line, fields })
        })
    }

    /// Lines that hold something, with their number from 1.
    fn lines(&self) -> impl Iterator<Item = (u64, &str)> {
        // Spreadsheets begin UTF-8 with a byte order mark.
        let text = self.text.strip_prefix('\u{feff}').unwrap_or(&self.text);
        let numbered = (1..).zip(text.lines());
        numbered
            .map(|(line, text)| {
                let end = self.comment.and_then(|comment| text.find(comment));
                (line, text[..end.unwrap_or(text.len())].trim())
            })
            .filter(|(_, text)| !text.is_empty())
    }
}

impl Row<'_> {
    /// Line of the record, from 1.
    pub(crate) fn line(&self) -> u64 {
        self.line
    }

    /// The text of a column.
    pub(crate) fn text(&self, column: usize) -> &str {
        &self.fields[column]
    }

    /// The finite number of a column.
    pub(crate) fn number(&self, column: usize) -> Result<f64, TableError> {
        let text = self.text(column);
        let value: f64 =
            text.parse().map_err(|_| self.wrong(column, format!("`{text}` is not a number")))?;
        if !value.is_finite() {
            return Err(self.wrong(column, format!("`{text}` is not a finite number")));
        }
        Ok(value)
    }

    /// An error at a field of this record.
    pub(crate) fn wrong(&self, column: usize, text: impl AsRef<str>) -> TableError {
        let name = &self.table.header[column];
        self.table.at(self.line, format!("column `{name}`: {}", text.as_ref()))
    }
}

/// The fields of a line.
fn split(line: &str) -> Result<Vec<String>, String> {
    if !line.contains('"') {
        return Ok(line.split(',').map(|field| field.trim().to_owned()).collect());
    }
    let mut fields = Vec::new();
    let mut rest = line;
    loop {
        let (field, after) = match rest.trim_start().strip_prefix('"') {
            Some(quoted) => unquote(quoted)?,
            None => {
                let end = rest.find(',').unwrap_or(rest.len());
                (rest[..end].trim().to_owned(), &rest[end..])
            }
        };
        fields.push(field);
        let after = after.trim_start();
        match after.strip_prefix(',') {
            Some(next) => rest = next,
            None if after.is_empty() => return Ok(fields),
            None => return Err(format!("`{after}` after a closing quote; allowed: a comma")),
        }
    }
}

/// A field up to its closing quote, and what follows.
fn unquote(text: &str) -> Result<(String, &str), String> {
    let mut field = String::new();
    let mut rest = text;
    loop {
        let end = rest.find('"').ok_or("a quote is not closed on its line")?;
        field.push_str(&rest[..end]);
        rest = &rest[end + 1..];
        match rest.strip_prefix('"') {
            Some(next) => {
                field.push('"');
                rest = next;
            }
            None => return Ok((field, rest)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str, comment: Option<char>) -> Result<Table, TableError> {
        Table::parse(text.as_bytes().to_vec(), Path::new("t.csv"), comment)
    }

    fn message(text: &str, comment: Option<char>) -> String {
        let read = || -> Result<(), TableError> {
            let table = table(text, comment)?;
            for row in table.rows() {
                row?;
            }
            Ok(())
        };
        read().unwrap_err().to_string()
    }

    #[test]
    fn lines_are_counted_through_blanks_comments_and_carriage_returns() {
        let text = "\u{feff}# made by hand\r\na,b\r\n\r\n1,2 # note\r\n# x\r\n3,oops\r\n";
        let table = table(text, Some('#')).unwrap();
        let rows: Vec<_> = table.rows().map(Result::unwrap).collect();
        assert_eq!(rows.iter().map(Row::line).collect::<Vec<_>>(), [4, 6]);
        assert_eq!(rows[0].number(1).unwrap(), 2.0);
        assert_eq!(
            rows[1].number(1).unwrap_err().to_string(),
            "t.csv:6: column `b`: `oops` is not a number"
        );
    }

    #[test]
    fn quoted_names_may_hold_commas_and_quotes() {
        let table = table("\"Time, s\" , \"the \"\"true\"\" strain\"\n 1, 2 \n", None).unwrap();
        assert_eq!(table.header(), ["Time, s", "the \"true\" strain"]);
        assert_eq!(table.rows().next().unwrap().unwrap().number(1).unwrap(), 2.0);
    }

    #[test]
    fn faults_of_form_name_their_line() {
        let cases = [
            ("", "t.csv:1: the file is empty"),
            ("\n\n", "t.csv:1: the file is empty"),
            ("a,b,a\n", "t.csv:1: column `a` appears twice"),
            ("a,,b\n", "t.csv:1: column 2 has no name"),
            ("a,b\n1,2\n3\n", "t.csv:3: 1 fields; allowed: 2"),
            ("a,b\n1,2,3\n", "t.csv:2: 3 fields; allowed: 2"),
            ("a,b\n\"1,2\n", "t.csv:2: a quote is not closed on its line"),
            ("a,b\n\"1\"x,2\n", "t.csv:2: `x,2` after a closing quote"),
        ];
        for (text, start) in cases {
            let message = message(text, None);
            assert!(message.starts_with(start), "{text:?}: {message}");
        }
    }

    #[test]
    fn a_number_is_a_finite_number() {
        let table = table("a\n1e-3\n-.5\nnan\ninf\n1e999\n\"\"\n0x1\n", None).unwrap();
        let numbers: Vec<_> = table.rows().map(|row| row.unwrap().number(0).ok()).collect();
        assert_eq!(numbers, [Some(1e-3), Some(-0.5), None, None, None, None, None]);
    }
}
