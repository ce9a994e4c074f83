//! Mistakes in arguments that the parser of the command line takes for something else: a decimal comma in `--set X=1,5`, where commas
//! separate values, a blank in such a list, a source where a command is expected, words of other tools for a command, flags with one
//! hyphen, and negative values.

use std::ffi::OsString;
use std::path::Path;

use clap::CommandFactory;
use clap::error::{ContextKind, ErrorKind};
use plcc_literal::distance::nearest;
use plcc_runtime::address;
use plcc_runtime::options::{negative_value, split_list};

use crate::cli::Cli;

/// Flags with several values, separated by commas.
const LISTS: [&str; 3] = ["--set", "--print", "--trace-signals"];

/// Words of other tools, and the command.
const COMMANDS: [(&str, &str); 16] = [
    ("compile", "build"),
    ("make", "build"),
    ("link", "build"),
    ("exec", "run"),
    ("simulate", "run"),
    ("start", "run"),
    ("lint", "check"),
    ("validate", "check"),
    ("verify", "check"),
    ("format", "fmt"),
    ("create", "new"),
    ("init", "new"),
    ("export", "convert"),
    ("import", "convert"),
    ("translate", "convert"),
    ("draw", "view"),
];

/// What is wrong, as one sentence for people.
pub fn fault(args: &[OsString]) -> Option<String> {
    let args: Vec<&str> = args.iter().filter_map(|arg| arg.to_str()).collect();
    if let Some(told) = args.get(1).and_then(|first| source_for_command(first)) {
        return Some(told);
    }
    if let Some(told) = args.get(1..).and_then(other_command) {
        return Some(told);
    }
    if let Some(told) = json_of_nothing(&args) {
        return Some(told);
    }
    let mut at = 0;
    while let Some(arg) = args.get(at) {
        at += 1;
        if *arg == "--" {
            return None;
        }
        let (flag, value, next) = match arg.split_once('=') {
            Some((flag, value)) if LISTS.contains(&flag) => (flag, value, args.get(at)),
            _ if LISTS.contains(arg) => match args.get(at) {
                Some(value) => (*arg, *value, args.get(at + 1)),
                None => continue,
            },
            _ => continue,
        };
        if flag == "--print" && value.trim().is_empty() {
            return Some("--print has no names; write for example --print Q0.0,MW10".to_string());
        }
        if let Some(told) = decimal_comma(flag, value) {
            return Some(told);
        }
        if let Some(told) = next.and_then(|next| list_with_blank(flag, value, next)) {
            return Some(told);
        }
    }
    None
}

/// What is wrong with arguments that the parser refuses, where it does not see the reason.
pub fn refused(error: &clap::Error, args: &[OsString]) -> Option<String> {
    let args: Vec<&str> = args.iter().filter_map(|arg| arg.to_str()).collect();
    let cli = Cli::command();
    match error.kind() {
        ErrorKind::UnknownArgument => {
            let command = cli.find_subcommand(args.get(1)?)?;
            one_hyphen(command, &args[2..]).or_else(|| negative_value(error, command, &args[2..]))
        }
        // The parser has suggestions of its own, but none for `rn`.
        ErrorKind::InvalidSubcommand if error.get(ContextKind::SuggestedSubcommand).is_none() => {
            let first = args.get(1)?;
            let meant = nearest(first, cli.get_subcommands().map(clap::Command::get_name))?;
            Some(format!("`{first}` is not a command; did you mean `{meant}`?"))
        }
        _ => None,
    }
}

/// `-cycles 5`
fn one_hyphen(command: &clap::Command, args: &[&str]) -> Option<String> {
    args.iter().take_while(|arg| **arg != "--").find_map(|arg| {
        let flag = arg.strip_prefix('-')?.split('=').next()?;
        let is_flag = command.get_arguments().any(|own| own.get_long() == Some(flag));
        is_flag.then(|| format!("`-{flag}` has one hyphen: write `--{flag}`"))
    })
}

/// `plcc main.scl`, `plcc tank`
fn source_for_command(first: &str) -> Option<String> {
    const SOURCES: [&str; 7] = ["stl", "awl", "scl", "gr7", "s7dcl", "xml", "toml"];
    let path = Path::new(first);
    let suffix = path.extension().map(|suffix| suffix.to_string_lossy().to_ascii_lowercase());
    let is_command = || {
        let mut words = COMMANDS.iter().map(|(word, _)| *word).chain(["help"]);
        words.any(|word| word == first) || Cli::command().get_subcommands().any(|command| command.get_name() == first)
    };
    let is_source = suffix.is_some_and(|suffix| SOURCES.contains(&suffix.as_str()))
        || first.contains('/') && path.exists()
        || path.is_dir() && !is_command();
    is_source.then(|| {
        format!(
            "`{first}` is not a command: write `plcc check {first}` to look for mistakes, `plcc run {first}` to run it, \
             `plcc build {first}` for an executable"
        )
    })
}

/// `plcc run DIR --json` without values that it could print.
fn json_of_nothing(args: &[&str]) -> Option<String> {
    let own: Vec<&str> = args.iter().copied().take_while(|arg| *arg != "--").collect();
    let has = |flag: &str| own.iter().any(|arg| arg.split('=').next() == Some(flag));
    let prints = ["--print", "--scenario", "--help", "-h"].into_iter().any(has);
    (own.get(1) == Some(&"run") && has("--json") && !prints)
        .then(|| "--json writes the values of --print; add for example --print Q0.0,MW10".to_string())
}

/// `plcc compile main.scl`
fn other_command(args: &[&str]) -> Option<String> {
    let (first, rest) = args.split_first()?;
    let (_, command) = COMMANDS.iter().find(|(word, _)| word == first)?;
    let meant = [&["plcc", *command][..], rest].concat().join(" ");
    Some(format!("`{first}` is not a command: write `{meant}`"))
}

/// `--print Q0.0 MW2`, `--print Q0.0, MW2`, `--set A=1 B=2`: a blank between the parts of a list, which makes a file of the next one.
fn list_with_blank(flag: &str, value: &str, next: &str) -> Option<String> {
    let is_value = match flag {
        _ if value.ends_with(',') => true,
        "--set" => next.contains('='),
        _ => address::parse(next).is_some(),
    };
    if !is_value || next.starts_with('-') || Path::new(next).exists() {
        return None;
    }
    let first = value.trim_end_matches(',');
    Some(format!("`{next}` is not a file: {flag} takes a list without blanks; write {flag} {first},{next}"))
}

/// `DB.r=1,5`, `Q4,0`: digits alone after a comma.
fn decimal_comma(flag: &str, value: &str) -> Option<String> {
    // As the list is read: commas in brackets and quotes separate nothing.
    let parts = split_list(&[value.to_string()]);
    let parts: Vec<&str> = parts.iter().map(String::as_str).collect();
    let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let at = (1..parts.len())
        .find(|at| is_digits(parts[*at].trim()) && parts[at - 1].ends_with(|c: char| c.is_ascii_digit()))?;
    // `Key=1,5` may be a list with something forgotten, but no name is made of digits.
    // `1.000,5` has points between groups of digits.
    let (name, number) = parts[at - 1].rsplit_once('=').unwrap_or(("", parts[at - 1]));
    let whole = if name.is_empty() { parts[at - 1].to_string() } else { format!("{name}={}", number.replace('.', "")) };
    let joined = format!("{whole}.{}", parts[at].trim());
    let meant = [&parts[..at - 1], &[joined.as_str()], &parts[at + 1..]].concat().join(",");
    let what = match flag {
        "--set" => "a comma separates values, and a number has a decimal point",
        _ => "a comma separates names, and an address has a point before its bit",
    };
    Some(format!("{flag} {value}: {what}; write {flag} {meant}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(args: &[&str]) -> Option<String> {
        let args: Vec<OsString> = std::iter::once(&"plcc").chain(args).map(OsString::from).collect();
        fault(&args)
    }

    #[test]
    fn decimal_commas() {
        let set = "a comma separates values, and a number has a decimal point; write";
        assert_eq!(told(&["run", "x", "--set", "DB.r=1,5"]), Some(format!("--set DB.r=1,5: {set} --set DB.r=1.5")));
        assert_eq!(told(&["run", "--set=A=1,B=2,5"]), Some(format!("--set A=1,B=2,5: {set} --set A=1,B=2.5")));
        assert!(told(&["run", "--set", "A=1.000,5"]).is_some_and(|told| told.ends_with("write --set A=1000.5")));
        assert!(told(&["run", "--print", "Q4,0"]).is_some_and(|told| told.ends_with("write --print Q4.0")));
        assert_eq!(told(&["run", "x", "--set", "A=1,B=2", "--print", "A,MW10,Q4.0"]), None);
        assert_eq!(told(&["run", "x", "--set", "MD20=B#(1,14,100,120)", "--print", "D.a[1,2,3]"]), None);
    }

    #[test]
    fn lists_have_no_blanks() {
        let list = "takes a list without blanks; write";
        assert_eq!(
            told(&["run", "x", "--print", "QW0", "MW2"]),
            Some(format!("`MW2` is not a file: --print {list} --print QW0,MW2"))
        );
        assert_eq!(
            told(&["run", "--print", "Motor,", "Speed", "x"]),
            Some(format!("`Speed` is not a file: --print {list} --print Motor,Speed"))
        );
        assert_eq!(
            told(&["run", "x", "--set=A=1", "B=2"]),
            Some(format!("`B=2` is not a file: --set {list} --set A=1,B=2"))
        );
        assert_eq!(told(&["run", "--print", "QW0", "main.scl"]), None);
        assert_eq!(told(&["run", "--print", "QW0", "--cycles", "5"]), None);
    }

    #[test]
    fn values_have_names() {
        let none = Some("--print has no names; write for example --print Q0.0,MW10".to_string());
        assert_eq!(told(&["run", "x", "--print", ""]), none);
        assert_eq!(told(&["run", "x", "--print= "]), none);
        let json = "--json writes the values of --print; add for example --print Q0.0,MW10";
        assert_eq!(told(&["run", "x", "--json"]).as_deref(), Some(json));
        assert_eq!(told(&["run", "x", "--json", "--print=Q0.0"]), None);
        assert_eq!(told(&["run", "x", "--json", "--scenario", "a.toml"]), None);
        assert_eq!(told(&["test", "x", "--json"]), None);
    }

    #[test]
    fn a_source_is_not_a_command() {
        assert!(told(&["main.scl"]).is_some_and(|told| told.contains("plcc check main.scl")));
        assert_eq!(told(&["check", "main.scl"]), None);
        assert_eq!(told(&["--version"]), None);
    }

    /// What the user is told about arguments that the parser refuses.
    fn told_after(args: &[&str]) -> Option<String> {
        let args: Vec<OsString> = std::iter::once(&"plcc").chain(args).map(OsString::from).collect();
        let error = Cli::command().try_get_matches_from(&args).expect_err("the parser refuses it");
        refused(&error, &args)
    }

    #[test]
    fn one_hyphen_before_a_long_name() {
        let told = told_after;
        let meant = Some("`-cycles` has one hyphen: write `--cycles`".to_string());
        assert_eq!(told(&["run", "x", "-cycles", "5"]), meant);
        assert_eq!(told(&["run", "-cycles=5", "x"]), meant);
        assert_eq!(told(&["run", "x", "-x"]), None);
        assert_eq!(told(&["run", "x", "--what"]), None);
    }

    #[test]
    fn times_are_not_negative() {
        let meant = Some("--cycle-time takes no negative value such as `-10ms`".to_string());
        assert_eq!(told_after(&["run", "x", "--cycle-time", "-10ms"]), meant);
        assert_eq!(told_after(&["run", "x", "--what", "-10ms"]), None);
    }

    #[test]
    fn slips_in_commands() {
        assert_eq!(told_after(&["rn", "x"]), Some("`rn` is not a command; did you mean `run`?".to_string()));
        assert_eq!(told_after(&["zzzzz"]), None);
    }

    #[test]
    fn words_of_other_tools() {
        let meant = "`compile` is not a command: write `plcc build main.scl -o main`".to_string();
        assert_eq!(told(&["compile", "main.scl", "-o", "main"]), Some(meant));
        assert_eq!(told(&["lint"]), Some("`lint` is not a command: write `plcc check`".to_string()));
        assert_eq!(told(&["build", "compile"]), None);
    }
}
