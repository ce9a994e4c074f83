//! Contents of projects that plcc does not read are reported, never skipped.

use plcc_diag::{Code, FileId, Severity};

use super::{parse, tags};

/// Codes, severities and titles of the messages of a project with a program.
fn told(interface: &str, body: &str, more: &str) -> Vec<(Code, Severity, String)> {
    let text = format!(
        "<project><types><dataTypes/><pous><pou name=\"Main\" pouType=\"program\"><interface>{interface}</interface>\
         <body>{body}</body></pou></pous></types>{more}</project>"
    );
    let (_, mut messages) = parse(FileId(0), &text);
    messages.extend(tags(FileId(0), &text).1);
    messages.into_iter().map(|message| (message.code, message.severity, message.title)).collect()
}

fn errors(interface: &str, body: &str, more: &str) -> Vec<String> {
    let errors = told(interface, body, more).into_iter().filter(|(_, severity, _)| *severity == Severity::Error);
    errors.map(|(_, _, title)| title).collect()
}

fn st(text: &str) -> String {
    format!("<ST><p><![CDATA[{text}]]></p></ST>")
}

#[test]
fn code_in_c_is_an_error() {
    let title = vec!["plcc does not read code in C".to_string()];
    assert_eq!(errors("", &st("{{ x = 1; }}"), ""), title);
    assert_eq!(errors("", &st("{ x = 1; }"), ""), title);
    assert_eq!(errors("", &st("(* { x } *)"), ""), Vec::<String>::new());
}

#[test]
fn unknown_parts_are_errors() {
    let list = "<accessVars><variable name=\"a\"><type><INT/></type></variable></accessVars>";
    assert_eq!(errors(list, &st(""), ""), ["plcc does not read the list `accessVars` of an interface"]);
    let untyped = "<localVars><variable name=\"a\"/></localVars>";
    assert_eq!(errors(untyped, &st(""), ""), ["a variable without a name or a type"]);
    let value = "<localVars><variable name=\"a\"><type><INT/></type><initialValue><other/></initialValue></variable></localVars>";
    assert_eq!(errors(value, &st(""), ""), ["plcc does not read the initial value `other`"]);
    let method = "<addData><data name=\"x\"><Method name=\"Go\"/></data></addData>";
    assert_eq!(errors("", &st(""), method), ["plcc does not read the method `Go`"]);
    let lost = "<externalVars><variable name=\"a\"><type><INT/></type></variable></externalVars>";
    assert_eq!(errors(lost, &st(""), ""), ["the project has no global variable `a`"]);
    let instance = "<instances><configurations><configuration name=\"C\"><resource name=\"R\">\
                    <pouInstance name=\"I\" typeName=\"Gone\"/></resource></configuration></configurations></instances>";
    assert_eq!(errors("", &st(""), instance), ["the project has no program `Gone`"]);
    let event = instance.replace(
        "<pouInstance name=\"I\" typeName=\"Gone\"/>",
        "<task name=\"T\" single=\"a\"><pouInstance name=\"I\" typeName=\"Main\"/></task>",
    );
    assert_eq!(errors("", &st(""), &event), ["plcc does not read tasks that an event starts, such as `a`"]);
    let edge = "<FBD><inVariable localId=\"1\" edge=\"rising\"><expression>a</expression></inVariable>\
                <outVariable localId=\"2\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn>\
                <expression>b</expression></outVariable></FBD>";
    assert_eq!(errors("", edge, ""), ["plcc does not read an edge at a variable"]);
    let second = "<IL><p>ST a</p></IL>";
    assert_eq!(errors("", second, ""), ["there is no current result here"]);
}

#[test]
fn lines_from_objects_that_are_gone_are_left_out() {
    let body = "<FBD><outVariable localId=\"2\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn>\
                <expression>b</expression></outVariable></FBD>";
    let found = told("", body, "");
    let title = "a line comes from object 1, which is not in the network";
    assert_eq!(found, [(Code::Tolerated, Severity::Warning, title.to_string())]);
    // A coil is wrong without its line.
    let coil = "<LD><leftPowerRail localId=\"7\"/><coil localId=\"2\"><connectionPointIn><connection refLocalId=\"1\"/>\
                </connectionPointIn><variable>b</variable></coil></LD>";
    assert_eq!(told("", coil, ""), [(Code::NoSource, Severity::Error, title.to_string())]);
}

#[test]
fn programs_without_a_task_are_told() {
    let other = "<instances><configurations><configuration name=\"C\"><resource name=\"R\"><task name=\"T\"/>\
                 </resource></configuration></configurations></instances>";
    assert_eq!(told("", &st(""), other), [], "the only program runs in OB 1");
    let short = other.replace(
        "<task name=\"T\"/>",
        "<task name=\"T\" interval=\"T#100us\"><pouInstance name=\"I\" typeName=\"Main\"/></task>",
    );
    let title = "an interval of T#100us is longer here: OBs run at whole milliseconds";
    assert_eq!(told("", &st(""), &short), [(Code::Tolerated, Severity::Warning, title.to_string())]);
}

#[test]
fn constants_outside_a_subrange_are_errors() {
    let list = |value: &str| {
        format!(
            "<localVars><variable name=\"p\"><type><subrangeSigned><range lower=\"-5\" upper=\"100\"/><baseType><INT/></baseType>\
             </subrangeSigned></type><initialValue><simpleValue value=\"{value}\"/></initialValue></variable>\
             <variable name=\"i\"><type><INT/></type></variable></localVars>"
        )
    };
    let none: [&str; 0] = [];
    assert_eq!(errors(&list("-5"), &st("p := 100; p := -5; i := 101; p := i;"), ""), none);
    assert_eq!(errors(&list("101"), &st(""), ""), ["101 is outside the range of its type"]);
    assert_eq!(errors(&list("0"), &st("p := -6;"), ""), ["-6 is outside the range of its type"]);
}

#[test]
fn retentive_variables_are_told() {
    let list = "<localVars retain=\"true\"><variable name=\"a\"><type><INT/></type></variable></localVars>";
    let title = "retentive variables begin each run with their start values without `--retain`: `a`".to_string();
    assert_eq!(told(list, &st(""), ""), [(Code::Tolerated, Severity::Warning, title)]);
    let variables: String = ["a", "b", "c", "d", "e"]
        .map(|name| format!("<variable name=\"{name}\"><type><INT/></type></variable>"))
        .concat();
    let globals = format!(
        "<instances><configurations><configuration name=\"C\"><globalVars name=\"G\" persistent=\"true\">{variables}</globalVars>\
         </configuration></configurations></instances>"
    );
    let title =
        "retentive variables begin each run with their start values without `--retain`: `a`, `b`, `c` and 2 others"
            .to_string();
    assert_eq!(told("", &st(""), &globals), [(Code::Tolerated, Severity::Warning, title)]);
}

#[test]
fn the_result_of_il_has_a_type_at_a_label() {
    let variables = "<localVars><variable name=\"a\"><type><BOOL/></type></variable><variable name=\"i\"><type><INT/></type></variable></localVars>";
    let il = |text: &str| format!("<IL><p><![CDATA[{text}]]></p></IL>");
    let none: [&str; 0] = [];
    assert_eq!(errors(variables, &il("LD a\nJMPC one\nLD i\nJMP end\none: LD 1\nend: ST i"), ""), none);
    assert_eq!(
        errors(variables, &il("LD a\nJMPC one\nLD 2\nJMP end\none: LD 1\nend: ST i"), ""),
        ["the type of the result at this label is not known"]
    );
    assert_eq!(
        errors(variables, &il("LD i\nCAL f()\nend: ST i"), ""),
        ["there is no current result here", "the type of the result at this label is not known"]
    );
}
