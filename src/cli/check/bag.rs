//! What is in a bag.

use std::path::Path;

use graintwin::command::Disposition;
use graintwin::record::reader::{Bag, Survey};
use graintwin::record::recover::{Account, File};
use graintwin::record::{END, PROGRAM};

use crate::cli::{Failure, Outcome, summary};

/// Also says how it ends: a damaged bag is reported up to the damage.
pub(super) fn describe(file: &Path) -> Result<(String, Outcome), Failure> {
    let bag = Bag::open(file).map_err(Failure::input)?;
    let survey = bag.survey().map_err(Failure::input)?;
    let account = Account::of(&bag).map_err(Failure::input)?;
    let mut table = Table(format!("bag             {}\n", file.display()));
    contents(&mut table, &survey);
    if account.own {
        run(&mut table, &survey, &account);
    }
    files(&mut table, &account);
    if account.is_whole() {
        table.line("state", "whole");
        return Ok((table.0, Outcome::Done));
    }
    what_is_lost(&mut table, &account, file);
    Ok((table.0, Outcome::Incomplete))
}

struct Table(String);

impl Table {
    fn line(&mut self, name: &str, what: &str) {
        self.0.push_str(&format!("{name:<16}{what}\n"));
    }
}

fn contents(table: &mut Table, survey: &Survey) {
    if let Some((first, last)) = survey.times {
        let seconds = (last - first) as f64 * 1e-9;
        table.line("recorded", &format!("{} messages over {seconds:.3} s", survey.messages()));
    }
    for (topic, found) in &survey.topics {
        table.line(
            "",
            &format!("{:>7}  {topic} ({}, {})", found.messages, found.kind, found.encoding),
        );
    }
    for attachment in &survey.attachments {
        table.line("attachment", &format!("{} ({} bytes)", attachment.name, attachment.bytes));
    }
    for (name, record) in &survey.metadata {
        for (key, value) in record.iter().filter(|(_, value)| !value.contains('\n')) {
            table.line("metadata", &format!("{name}: {key} = {value}"));
        }
    }
}

/// What run was recorded, and how far it came.
fn run(table: &mut Table, survey: &Survey, account: &Account) {
    let empty = Default::default();
    let program = survey.metadata.get(PROGRAM).unwrap_or(&empty);
    let of = |key: &str| program.get(key).map_or("unknown", String::as_str);
    table.line(
        "made by",
        &format!(
            "graintwin {} ({}), kernels {}, {} threads, seed {}",
            of("version"),
            of("features"),
            of("kernels"),
            of("threads"),
            of("seed")
        ),
    );
    let answers = &account.answers;
    let count: u64 = answers.dispositions.values().sum();
    let by_name =
        answers.dispositions.iter().map(|(&number, count)| format!("{count} {}", name(number)));
    let by_name = by_name.collect::<Vec<_>>().join(", ");
    let by_name = if by_name.is_empty() { by_name } else { format!(" ({by_name})") };
    table.line("commands", &format!("{count} with their reports{by_name}"));
    if answers.unanswered > 0 {
        table.line("", &format!("{} whose answer is not whole", answers.unanswered));
    }
    match &answers.last {
        Some((session, sequence, increment)) => {
            table.line("increments", &format!("complete up to {increment}"));
            table.line("last report", &format!("sequence {sequence} of session `{session}`"));
        }
        None => table.line("increments", "none is complete"),
    }
    match survey.metadata.get(END).and_then(|end| end.get("state")) {
        Some(state) => table.line("end", &format!("ended in order, state {state}")),
        None => table.line("end", "killed, or not recorded to its end"),
    }
}

/// The name of a disposition by its number in a report.
fn name(number: u8) -> String {
    let known = DISPOSITIONS.into_iter().find(|known| *known as u8 == number);
    known.map_or_else(|| number.to_string(), summary::name)
}

const DISPOSITIONS: [Disposition; 10] = [
    Disposition::Applied,
    Disposition::Clamped,
    Disposition::Duplicate,
    Disposition::Stale,
    Disposition::Gap,
    Disposition::OutOfOrder,
    Disposition::Limit,
    Disposition::Invalid,
    Disposition::NotConverged,
    Disposition::Held,
];

fn files(table: &mut Table, account: &Account) {
    for File { path, messages, damage, behind, .. } in &account.files {
        let state = match (damage, behind) {
            (Some(_), _) => "damaged",
            (None, true) => "not read, behind a damage",
            (None, false) => "whole",
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        table.line("file", &format!("{name}: {messages} messages, {state}"));
    }
}

/// What is damaged, what `recover` would make of it, and how to call that.
fn what_is_lost(table: &mut Table, account: &Account, file: &Path) {
    for damage in account.files.iter().filter_map(|file| file.damage.as_ref()) {
        table.line("state", &format!("damaged: {damage}"));
    }
    if account.dropped > 0 && !account.is_damaged() {
        table.line("state", "the last answer is not whole");
    }
    if !account.described {
        table.line("state", "metadata.yaml is missing, or names not all files: ROS 2 needs it");
    }
    let what = match account.own {
        true => format!(
            "{} messages up to the last whole increment, and drop {}",
            account.kept, account.dropped
        ),
        false => format!("{} messages", account.kept),
    };
    table.line("recover", &format!("would keep {what}:"));
    let quoted = |path: &Path| {
        let text = path.display().to_string();
        let harmless = |c: char| c.is_alphanumeric() || "/._-+".contains(c);
        match text.chars().all(harmless) {
            true => text,
            false => format!("'{}'", text.replace('\'', r"'\''")),
        }
    };
    let out = file.with_file_name(format!(
        "{}_recovered",
        file.file_stem().unwrap_or_default().to_string_lossy()
    ));
    table.line("", &format!("graintwin recover {} --out {}", quoted(file), quoted(&out)));
}
