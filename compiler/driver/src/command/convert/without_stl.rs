//! STL of a program for an S7-1200, which has none: it is for another CPU, and so are the settings beside it.

use plcc_abi::image::Family;
use plcc_model::profile;
use serde::Deserialize;
use toml::Spanned;

use super::companions::cpu_of_pragma;

/// The CPU of the statements if nothing names one.
pub(super) const USUAL: &str = "s7-1500";

#[derive(Deserialize)]
struct Settings {
    cpu: Option<Spanned<String>>,
}

/// Whether it is the name of an S7-1200.
pub(super) fn is_without(cpu: &str) -> bool {
    profile::lookup(cpu).is_some_and(|profile| profile.family == Family::S71200)
}

/// The CPU that statements are for, where `named` is the one of the command line.
fn with(named: Option<&str>) -> &str {
    named.filter(|cpu| !is_without(cpu)).unwrap_or(USUAL)
}

/// A statement list whose pragmas `//@ cpu` name a CPU with STL.
pub(super) fn text(list: &str, named: Option<&str>) -> String {
    let line = |line: &str| match cpu_of_pragma(line).filter(|cpu| is_without(cpu)) {
        Some(cpu) => line.replacen(cpu, with(named), 1),
        None => line.to_string(),
    };
    list.split_inclusive('\n').map(line).collect()
}

/// The text of plc.toml with a CPU that has STL.
pub(super) fn settings(text: String, named: Option<&str>) -> String {
    let cpu = toml::from_str::<Settings>(&text).ok().and_then(|settings| settings.cpu);
    let Some(cpu) = cpu.filter(|cpu| is_without(cpu.get_ref())) else { return text };
    let mut changed = text;
    changed.replace_range(cpu.span(), &format!("\"{}\"", with(named)));
    changed
}

/// What is said where `cpu` is the CPU of the program.
pub(super) fn warning(cpu: &str) -> String {
    format!(
        "`{cpu}` has no STL: the statements and the settings beside them are for an S7-1500 (`--cpu` names another CPU)"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_cpus_without_stl_are_replaced() {
        assert_eq!(text("//@ cpu 1214C\nL 1214;\n", None), "//@ cpu s7-1500\nL 1214;\n");
        assert_eq!(text("//@ cpu s7-1200", Some("1511-1")), "//@ cpu 1511-1");
        assert_eq!(text("//@ cpu 315-2DP\n", None), "//@ cpu 315-2DP\n");
        let toml = "# a 1214C\ncpu = \"1214C\" # ours\n[ob.35]\nperiod = \"1s\"\n";
        assert_eq!(settings(toml.to_string(), Some("1214C")), toml.replace("\"1214C\"", "\"s7-1500\""));
        assert_eq!(settings("cpu = \"315-2DP\"\n".to_string(), None), "cpu = \"315-2DP\"\n");
    }
}
