//! Messages of the library, and what becomes of them.

use super::*;

fn of(message: &str, line: &str) -> (String, String) {
    let Wrong { title, help } = plain(message, line, line);
    (title, help)
}

fn same(message: &str, line: &str, title: &str, help: &str) {
    assert_eq!(of(message, line), (title.to_owned(), help.to_owned()));
}

#[test]
fn names_the_nearest_key() {
    let known = "expected one of `name`, `cpu`, `ob`";
    same(&format!("unknown field `nmae`, {known}"), "", "`nmae` is not a key here", "write `name`");
    same(&format!("unknown field `ob35`, {known}"), "", "`ob35` is not a key here", "write `ob.35`");
    same(&format!("unknown field `speed`, {known}"), "", "`speed` is not a key here", "the keys are name, cpu, ob");
    same("unknown variant `warmm`, expected one of `warm`, `hot`", "", "`warmm` is not a value here", "write `warm`");
    let (title, help) =
        ("the keys of a project have no heading", "remove `[project]`: write its keys at the top of the file");
    assert_eq!(of(&format!("unknown field `project`, {known}"), "[project]"), (title.to_owned(), help.to_owned()));
    same("missing field `slot`", "", "the key `slot` is missing here", "add `slot = …`");
    let twice = "expected one of `every`, `bit-memory`, `bit_memory`";
    same(&format!("unknown field `bitmemory`, {twice}"), "", "`bitmemory` is not a key here", "write `bit_memory`");
    same(&format!("unknown field `bit-memry`, {twice}"), "", "`bit-memry` is not a key here", "write `bit-memory`");
}

#[test]
fn the_interval_of_retentive_data_has_a_unit() {
    let title = "a time with its unit is expected here, not the number 100";
    same("invalid type: integer `100`, expected a string", "every = 100", title, "write `\"100ms\"`");
}

#[test]
fn numbers_have_no_zeros_before_them() {
    let title = "a number has no zeros before it";
    let coil = "write `coils = 0`, the address of coil 00001: addresses begin at 0";
    same("unexpected leading zero", "coils = 00001", title, coil);
    same("unexpected leading zero", "coils = 01", title, "write `coils = 1`");
    same("unexpected leading zero", "raw = [00, 5]", title, "write the number without them");
}

#[test]
fn words_of_other_tools_are_known() {
    let moment = "expected one of `cycle`, `time`, `set`, `expect`";
    same(&format!("unknown field `force`, {moment}"), "", "`force` is not a key here", "write `set`");
    same(&format!("unknown field `check`, {moment}"), "", "`check` is not a key here", "write `expect`");
    let device = "expected one of `modbus`, `unit`, `data`";
    same(&format!("unknown field `address`, {device}"), "", "`address` is not a key here", "write `modbus`");
    let data = "expected one of `at`, `coils`";
    same(&format!("unknown field `address`, {data}"), "", "`address` is not a key here", "write `at`");
}

#[test]
fn headings_of_texts_become_keys() {
    let text = "name = \"a\"\n[cpu]\n# which\ntype = \"315-2 DP\"\n";
    let wrong = plain_at("invalid type: map, expected a string", text, 11);
    assert_eq!(wrong.title, "`cpu` is a key with a text, not a heading");
    assert_eq!(wrong.help, "write `cpu = \"315-2 DP\"` at the top of the file, before the first heading");
}

#[test]
fn one_table_is_no_list() {
    let told = |text: &str| plain_at("invalid type: map, expected a string", text, 0);
    let Wrong { title, help } = told("[[retain]]\nfile = \"a\"\n");
    assert_eq!((title.as_str(), help.as_str()), ("`retain` is one table, not a list of them", "write `[retain]`"));
    assert_eq!(told("[[ob.35]]\nperiod = \"5ms\"\n").help, "write `[ob.35]`");
    assert_eq!(told("[[ob]]\nnumber = 35\n").help, "write `[ob.35]`");
}

#[test]
fn lists_that_are_not_closed_are_told() {
    let comma = "missing comma between array elements, expected `,`";
    let told = |text: &str, at: usize| plain_at(comma, text, at);
    let Wrong { title, help } = told("sources = [\"a.stl\"\nname = \"b\"\n", 20);
    assert_eq!(title, "the list before this line is not closed");
    assert_eq!(help, "write `sources = [\"a.stl\"]`");
    assert_eq!(told("sources = [\n\"a.stl\",\n[retain]\n", 22).help, "write `]` after `\"a.stl\"`");
    assert_eq!(told("sources = [\"a.stl\",\n[[retain]]\nfile = \"a\"\n", 32).help, "write `sources = [\"a.stl\"]`");
    assert_eq!(told("sources = [\"a.stl\" \"b.stl\"]\n", 19).title, "a comma is missing before this");
}

#[test]
fn keys_with_their_words_in_another_order_are_found() {
    let known = "expected one of `cycle_time`, `cycle_time_max`, `clock_memory`";
    let title = "`max_cycle_time` is not a key here";
    same(&format!("unknown field `max_cycle_time`, {known}"), "", title, "write `cycle_time_max`");
}

#[test]
fn tells_types_in_plain_words() {
    let string = "invalid type: integer `50`, expected a string";
    same(string, "", "a text in quotation marks is expected here, not the number 50", "write `\"50\"`");
    same(string, "cycle_time = 50", "a time with its unit is expected here, not the number 50", "write `\"50ms\"`");
    let fraction = "invalid type: floating point `0.01`, expected a string";
    let second = "a time with its unit is expected here, not the number 0.01";
    same(fraction, "cycle_time = 0.01", second, "write `\"0.01s\"`");
    let list = "invalid type: sequence, expected a map";
    let each = "write the value to each name, as in `set = { \"I0.0\" = 1 }`";
    same(list, "set = [\"I0.0\"]", "a table is expected here, not a list", each);
    let date = "invalid type: map, expected a string";
    let title = "a text in quotation marks is expected here, not a date";
    same(date, "start = 2026-01-31 06:00:00", title, "write `\"2026-01-31T06:00:00\"`");
    let array = "invalid type: integer `1000`, expected an array of length 2";
    let two = "a list of 2 values is expected here, not the number 1000";
    same(array, "raw = 1000", two, "write `raw = [1000, …]`");
    let table = "invalid type: map, expected an array of length 2";
    same(table, "raw = { low = 1 }", "a list of 2 values is expected here, not a table", "write `raw = […, …]`");
    let pair = "write `expect = { \"Q0.0\" = 1 }`";
    same(list, "expect = [\"Q0.0 = 1\"]", "a table is expected here, not a list", pair);
    let list = "invalid type: map, expected a sequence";
    same(list, "[at]", "a list of tables is expected here, not a table", "write `[[at]]`");
    let table = "invalid type: boolean `true`, expected struct Retain";
    let below = "write its keys below `[retain]`, or between `{` and `}`";
    same(table, "retain = true", "a table is expected here, not true", below);
    let list = "invalid type: string \"main.stl\", expected a sequence";
    same(list, "", "a list is expected here, not the text \"main.stl\"", "write `[\"main.stl\"]`");
    let byte = "invalid type: string \"MB 100\", expected i64";
    same(byte, "", "a whole number is expected here, not the text \"MB 100\"", "write `100`");
    let module = "invalid type: integer `8`, expected struct AddressKeys";
    let bytes = "write `inputs = { start = 8, bytes = … }`: the first byte and the number of bytes";
    same(module, "inputs = 8", "the addresses are expected here, not the number 8", bytes);
    let module = "invalid type: string \"4..7\", expected struct AddressKeys";
    let bytes = "write `outputs = { start = 4, bytes = 4 }`";
    same(module, "outputs = \"4..7\"", "the addresses are expected here, not the text \"4..7\"", bytes);
    let words = "write `startup = \"warm\"`; the others are `\"cold\"` and `\"hot\"`";
    same("wanted string or table", "startup = 5 # s", "a text in quotation marks is expected here, not 5", words);
    let switch = "invalid type: boolean `true`, expected a string";
    let port = "write `s7 = \"102\"` for clients on this computer, `s7 = \"0.0.0.0:102\"` for those of the network";
    same(switch, "s7 = true", "a port in quotation marks is expected here, not true", port);
    same(switch, "file = true", "a text in quotation marks is expected here, not true", "write `file = \"…\"`");
    let yes = "invalid type: string \"yes\", expected a boolean";
    same(yes, "", "true or false is expected here, not the text \"yes\"", "write `true`, without quotation marks");
}

#[test]
fn tells_which_numbers_are_possible() {
    let number = |message: &str| of(message, "").1;
    assert_eq!(number("invalid value: integer `-1`, expected u64"), "write 0 or a larger number");
    assert_eq!(number("invalid value: integer `300`, expected u8"), "write a number from 0 to 255");
    assert_eq!(number("invalid type: floating point `1.5`, expected u64"), "write `1` or `2`");
    let table = "invalid type: string \"I0.0 = 1\", expected a map";
    assert_eq!(of(table, "set = \"I0.0 = 1\"").1, "write `set = { \"I0.0\" = 1 }`");
}

#[test]
fn knows_habits_of_other_languages() {
    let joined = "a key and its value are joined by `=`";
    let missing = "missing assignment between key-value pairs, expected `=`";
    same(missing, "set = { \"I0.1\" := 1 }", joined, "write `set = { \"I0.1\" = 1 }`");
    same("key with no value, expected `=`", "cpu := \"1214C\"", joined, "write `cpu = \"1214C\"`");
    same("unexpected key or value", "cycle = 5;", "a line has no `;` at its end", "write `cycle = 5`");
    same("invalid literal string", "name = 'p", "the text is not closed on its line", "write `name = 'p'`");
    let heading = "write `at = …`, or the heading `[at]` before several keys";
    same("key with no value, expected `=`", "at:", joined, heading);
}

#[test]
fn headings_say_which_one() {
    let text = "[axis]\nmax_velocity = 5\n";
    let wrong = plain_at("invalid type: integer `5`, expected struct AxisKeys", text, 22);
    assert_eq!(
        (wrong.title.as_str(), wrong.help.as_str()),
        ("`[axis]` does not say which one", "write `[axis.Axis_1]`")
    );
}

#[test]
fn numbers_below_a_heading_and_ports_are_told() {
    let text = "[ob]\n30 = \"50ms\"\n";
    let wrong = plain_at("invalid type: string \"50ms\", expected struct ObKeys", text, 10);
    assert_eq!(wrong.help, "write `[ob.30]`, and its keys below it");
    let port = "invalid type: integer `99999`, expected a string";
    let title = "a port in quotation marks is expected here, not the number 99999";
    same(port, "web = 99999", title, "ports are 1 to 65535: write `web = \"8080\"`");
}

#[test]
fn proposes_what_is_meant() {
    let languages = "unknown variant `german`, expected `en` or `de`";
    same(languages, "", "`german` is not a value here", "write `de`");
    let formats = "unknown variant `decimal`, expected one of `bool`, `bin`, `hex`, `dec`, `date`";
    same(formats, "", "`decimal` is not a value here", "write `dec`");
    let missing = "`=` is missing between the key and its value";
    same("key with no value, expected `=`", "cpu \"s7-300\"", missing, "write `cpu = \"s7-300\"`");
    let joined = "a key and its value are joined by `=`";
    same("extra `=`, expected nothing", "cpu == \"s7-300\"", joined, "write `cpu = \"s7-300\"`");
    let pairs = "missing assignment between key-value pairs, expected `=`";
    same(pairs, "set = { \"I0.0\" : 1 }", joined, "write `set = { \"I0.0\" = 1 }`");
    let Wrong { title, help } = plain("unexpected key or value", ",", "cpu = \"s7-300\",");
    assert_eq!((title.as_str(), help.as_str()), ("a line has no `,` at its end", "write `cpu = \"s7-300\"`"));
    let quotes = "string values must be quoted, expected literal string";
    same(quotes, "sources = main.stl", "a text is written in quotation marks", "write `sources = [\"main.stl\"]`");
    let number = "invalid type: floating point `100.0`, expected i64";
    same(number, "", "a whole number is expected here, not the number 100.0", "write `100`");
    let twice = "the key `clock_memory` appears twice, under two names";
    same("duplicate field `clock_memory`", "", twice, "remove one of them: both mean the same");
}

#[test]
fn parts_of_a_table_have_commas_between_them() {
    let (quotes, title) =
        ("string values must be quoted, expected literal string", "parts are separated by `,`, not by `;`");
    same(quotes, "set = { \"Start\" = 1; }", title, "write `set = { \"Start\" = 1 }`");
    let comma = "missing comma between key-value pairs, expected `,`";
    let list = "unexpected `=` in array, expected array close, `]`";
    let braces = "names with their values are written in braces";
    same(list, "set = [\"I0.0\" = 1]", braces, "write `set = { \"I0.0\" = 1 }`");
    same(comma, "set = { \"a\" = 1; \"b;c\" = 0 }", title, "write `set = { \"a\" = 1, \"b;c\" = 0 }`");
}

#[test]
fn tables_are_closed() {
    let text = "[[at]]\ncycle = 1\nset = { \"Start\" = 1\nexpect = { \"Motor\" = 1 }\n\n[[at]]\n";
    let (title, help) = ("the table before this line is not closed", "write `set = { \"Start\" = 1 }`");
    for (message, line) in [
        ("missing comma between key-value pairs, expected `,`", "expect"),
        ("missing key for inline table element, expected key", "\n[[at]]"),
    ] {
        let at = text.find(line).unwrap_or_default() + usize::from(line.starts_with('\n'));
        assert_eq!(plain_at(message, text, at), Wrong { title: title.to_owned(), help: help.to_owned() });
    }
}

#[test]
fn a_table_is_no_list_of_tables() {
    let text = "[at]\ncycle = 1\n\n[[at]]\ncycle = 2\n";
    let wrong = plain_at("duplicate key", text, 19);
    assert_eq!(wrong.title, "`[at]` before this line is one table, and `[[at]]` a list of them");
    assert_eq!(wrong.help, "write `[[at]]` there, too");
}

#[test]
fn tells_the_form_in_plain_words() {
    let quotes = "string values must be quoted, expected literal string";
    same(quotes, "name = x # a", "a text is written in quotation marks", "write `name = \"x\"`");
    same(
        "key with no value, expected `=`",
        "name: \"x\"",
        "a key and its value are joined by `=`",
        "write `name = \"x\"`",
    );
    let joined = "a key and its value are joined by `=`";
    same("key with no value, expected `=`", "cpu: 1214C", joined, "write `cpu = \"1214C\"`");
    same("key with no value, expected `=`", "watchdog: 150 # ms", joined, "write `watchdog = 150`");
    same(quotes, "cpu = “315-2DP”", "a text is written in quotation marks", "write `cpu = \"315-2DP\"`");
    let round = "a list is written in brackets";
    same(quotes, "sources = (\"a.stl\")", round, "write `sources = [\"a.stl\"]`");
    same(quotes, "sources = (a.stl, b.stl)", round, "write `sources = [\"a.stl\", \"b.stl\"]`");
    let name = "the heading does not begin with a name";
    same(quotes, "[.ob]", name, "write `[ob]`");
    same(quotes, "[[]]", name, "write the name of a table, as in `[retain]`");
    same(quotes, "= 5", "the key is missing before `=`", "write `key = 5`");
    same(quotes, "[ob.]", "the heading does not say which one", "write `[ob.35]`");
    same("invalid date", "cpu = 315-2DP", "a text is written in quotation marks", "write `cpu = \"315-2DP\"`");
    same("key with no value, expected `=`", "// my plant", "a comment begins with `#`", "write `# my plant`");
    let path = "write `sources = [\"src/main.scl\"]`: `/` is between folders";
    let escape = "missing escaped value, expected `b`, `f`";
    same(escape, r#"sources = ["src\main.scl"]"#, "`\\` begins a special character in a text", path);
}
