//! Runs the passes that the first line of an IR file names (`; passes: fold, dead-code`) and prints the result:
//! `cargo run --release -p plcc-opt --example passes FILE`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("a file is expected")?;
    let text = std::fs::read_to_string(path)?;
    print!("{}", plcc_opt::run_listed_passes(&text)?);
    Ok(())
}
