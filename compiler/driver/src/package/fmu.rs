//! A unit of a co-simulation: a ZIP file with the model description and a shared library.

use std::io::{Cursor, Write as _};

use plcc_abi::ProgramImage;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::description::{Description, describe};

/// Version of the interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Version {
    /// 2.0.
    #[value(name = "2")]
    V2,
    /// 3.0.
    #[value(name = "3")]
    V3,
}

/// The unit of a program and its library. And how many variables are left out. `Err`: the error of the archive.
pub fn pack(image: &ProgramImage, library: &[u8], version: Version) -> zip::result::ZipResult<(Vec<u8>, usize)> {
    let identifier = identifier(&image.name);
    let Description { xml, left_out } = describe(image, &identifier, version);
    let platform = match version {
        Version::V2 => "linux64",
        Version::V3 => "x86_64-linux",
    };
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    // The time stamp is the first that a ZIP file can have.
    let options = SimpleFileOptions::default().last_modified_time(DateTime::default());
    let options = options.compression_method(CompressionMethod::Deflated);
    archive.start_file("modelDescription.xml", options.unix_permissions(0o644))?;
    archive.write_all(xml.as_bytes())?;
    archive.start_file(format!("binaries/{platform}/{identifier}.so"), options.unix_permissions(0o755))?;
    archive.write_all(library)?;
    Ok((archive.finish()?.into_inner(), left_out))
}

/// The name as C and file systems can have it.
fn identifier(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    match plain.starts_with(|c: char| c.is_ascii_alphabetic()) {
        true => plain,
        false => format!("plc_{plain}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_those_of_c() {
        assert_eq!(identifier("water-tank"), "water_tank");
        assert_eq!(identifier("2 Füße"), "plc_2_F__e");
        assert_eq!(identifier(""), "plc_");
    }
}
