use plcc_diag::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let text = plcc_syntax::decode(&std::fs::read(&args[2]).unwrap());
    let options = plcc_syntax::ParseOptions { mnemonics: None, pragmas: args.iter().any(|a| a == "-p") };
    if args[1] == "tokens" { print!("{}", plcc_syntax::stl::tokens_text(&text, &options)); return; }
    let t = std::time::Instant::now();
    let (unit, diags) = plcc_syntax::parse(FileId(0), &text, &options);
    let dt = t.elapsed();
    let f = SourceFile::new("x", text.clone());
    for d in &diags {
        let (l, c) = f.line_column(d.primary.span.start);
        println!("{}:{}: {} {} [{}] <{}>  help: {}", l, c, d.code.name(), d.title, &text[d.primary.span.range()].replace('\n', "\\n"), d.primary.text, d.help.clone().unwrap_or_default());
    }
    if args[1] == "ast" { print!("{}", plcc_syntax::ast_text(&unit)); }
    if args[1] == "time" { println!("{:?} lines {} diags {}", dt, text.lines().count(), diags.len()); }
}
