//! An S7-200 as clients of S7 see it.

use libtest_mimic::Failed;

use crate::hostile::{CONNECT, SETUP, asks};
use crate::process::{self, Plc, free_port};

/// A job that reads one item: transport size, number of elements, area, address in bits.
fn read([transport, count, area, address]: [u8; 4]) -> [u8; 31] {
    let head = [3, 0, 0, 31, 2, 0xF0, 0x80, 0x32, 1, 0, 0, 0, 5, 0, 14, 0, 0, 4, 1, 0x12, 10, 0x10];
    let item = [transport, 0, count, 0, 0, area, 0, 0, address];
    let mut frame = [0; 31];
    frame[..22].copy_from_slice(&head);
    frame[22..].copy_from_slice(&item);
    frame
}

/// Asks for status list 0011, the identification.
const IDENTIFICATION: [u8; 33] = [
    3, 0, 0, 33, 2, 0xF0, 0x80, 0x32, 7, 0, 0, 0, 4, 0, 8, 0, 8, 0, 1, 0x12, 4, 0x11, 0x44, 1, 0, 0xFF, 9, 0, 4, 0,
    0x11, 0, 0,
];

/// A job that writes one word of an area.
fn write(area: u8, byte: u16) -> [u8; 37] {
    let [high, low] = (8 * byte).to_be_bytes();
    [
        3, 0, 0, 37, 2, 0xF0, 0x80, 0x32, 1, 0, 0, 0, 6, 0, 14, 0, 6, 5, 1, 0x12, 10, 0x10, 4, 0, 1, 0, 0, area, 0,
        high, low, 0, 4, 0, 16, 0x12, 0x34,
    ]
}

const AQ: u8 = 0x07;
const SM: u8 = 0x05;

const STOP: [u8; 33] = [
    3, 0, 0, 33, 2, 0xF0, 0x80, 0x32, 1, 0, 0, 0, 7, 0, 16, 0, 0, 0x29, 0, 0, 0, 0, 0, 9, b'P', b'_', b'P', b'R', b'O',
    b'G', b'R', b'A', b'M',
];

/// The code of the only item that was written.
fn code(answer: &[u8], expected: u8) -> Result<(), Failed> {
    match answer.last() {
        Some(code) if *code == expected => Ok(()),
        _ => Err(format!("the write is answered with {answer:02X?}, not with {expected:02X}").into()),
    }
}

/// Clients learn which CPU the program is for, not another one of its family. The name of the CPU by bytes and by bits; peripheral addresses
/// are those of other CPUs.
pub fn areas() -> Result<(), Failed> {
    let (folder, port) = (tempfile::tempdir()?, free_port());
    let (source, out) = (folder.path().join("main.awl"), folder.path().join("s7200"));
    std::fs::write(
        &source,
        "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNETWORK 1\nLD SM0.0\n= Q0.0\nEND_ORGANIZATION_BLOCK\n",
    )?;
    process::plcc(&["build", "--quiet", "--services", "--cpu", "224XP"], &[&source], &out)?;
    let web = free_port();
    let (s7, page) = (port.to_string(), web.to_string());
    let plc = Plc::run(&out, &["--s7", &s7, "--web", &page, "--access", "control", "--set", "AIW2=1234"])?;
    // Transport size, elements, area, address; then the item in the answer. `C` is 2#0100_0011.
    let cases: [([u8; 4], &[u8]); 7] = [
        ([4, 1, 0x06, 16], &[0xFF, 4, 0, 16, 0x04, 0xD2]),
        ([2, 9, 0x03, 0], b"\xFF\x04\0\x48CPU 224XP"),
        ([1, 1, 0x03, 0], &[0xFF, 3, 0, 1, 1]),
        ([1, 1, 0x03, 2], &[0xFF, 3, 0, 1, 0]),
        ([1, 1, 0x82, 0], &[0xFF, 3, 0, 1, 1]),
        ([2, 1, 0x80, 0], &[5, 0, 0, 0]),
        ([1, 1, 0x80, 0], &[5, 0, 0, 0]),
    ];
    for (item, expected) in cases {
        let answer = asks(port, &[CONNECT, SETUP, &read(item)])?;
        if !answer.ends_with(expected) {
            return Err(format!("{item:02X?} is answered with {answer:02X?}").into());
        }
    }
    let answer = asks(port, &[CONNECT, SETUP, &IDENTIFICATION])?;
    let order = b"6ES7 214-2AD        ";
    if !answer.windows(order.len()).any(|part| part == order) {
        return Err(format!("the identification is {answer:02X?}").into());
    }
    // V is not a data block.
    let info = process::get(web, "/info")?;
    if !info.contains(r#""blocks":{"OB":1}"#) || !info.contains(r#""V memory":"#) || info.contains("data blocks") {
        return Err(info.into());
    }
    // In STOP nobody writes analog outputs.
    asks(port, &[CONNECT, SETUP, &write(AQ, 0)]).and_then(|answer| code(&answer, 0xFF))?;
    asks(port, &[CONNECT, SETUP, &STOP])?;
    std::thread::sleep(std::time::Duration::from_millis(200));
    asks(port, &[CONNECT, SETUP, &write(AQ, 0)]).and_then(|answer| code(&answer, 3))?;
    // SMB0 to SMB29 are read-only.
    for (byte, expected) in [(0, 3), (28, 3), (29, 3), (32, 0xFF)] {
        asks(port, &[CONNECT, SETUP, &write(SM, byte)]).and_then(|answer| code(&answer, expected))?;
    }
    plc.end().map(drop)
}

/// A CPU has no more than its own timers. Source: S7-200 system manual, memory ranges.
pub fn limits() -> Result<(), Failed> {
    let (folder, port) = (tempfile::tempdir()?, free_port());
    let (source, out) = (folder.path().join("main.awl"), folder.path().join("s7200"));
    std::fs::write(
        &source,
        "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNETWORK 1\nLD SM0.0\n= Q0.0\nEND_ORGANIZATION_BLOCK\n",
    )?;
    process::plcc(&["build", "--quiet", "--services", "--cpu", "212"], &[&source], &out)?;
    let plc = Plc::run(&out, &["--s7", &port.to_string()])?;
    // T63, T64, C63, C64 as words.
    for (area, number, expected) in [
        (0x1F, 63, &[0xFF, 4, 0, 16, 0, 0][..]),
        (0x1F, 64, &[5, 0, 0, 0]),
        (0x1E, 63, &[0xFF, 4, 0, 16, 0, 0]),
        (0x1E, 64, &[5, 0, 0, 0]),
    ] {
        let answer = asks(port, &[CONNECT, SETUP, &read([4, 1, area, number])])?;
        if !answer.ends_with(expected) {
            return Err(format!("{number} of area {area:02X} is answered with {answer:02X?}").into());
        }
    }
    plc.end().map(drop)
}

/// What a client of OPC UA finds when it browses: all that the program names, timers and counters in their folders.
pub fn browsing() -> Result<(), Failed> {
    let (folder, port) = (tempfile::tempdir()?, free_port().to_string());
    let (source, out) = (folder.path().join("main.awl"), folder.path().join("s7200"));
    std::fs::write(
        &source,
        "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\n\
         NETWORK 1\nLD V10.3\n= Q0.0\nTON T37, 100\n\
         NETWORK 2\nLD V10.3\nLD V10.3\nCTU C5, 10\n\
         NETWORK 3\nLD V10.3\nMOVW 5, VW100\nMOVW AIW2, AQW0\n\
         NETWORK 4\nLD SM0.5\nA S0.1\nMOVB 4, SMB31\nLDI I0.3\n=I Q0.1\nEND_ORGANIZATION_BLOCK\n",
    )?;
    process::plcc(&["build", "--quiet", "--services", "--cpu", "224XP"], &[&source], &out)?;
    let plc = Plc::run_in(folder.path(), &out, &["--opcua", &port])?;
    let certificates = folder.path().join("opcua").display().to_string();
    crate::talk(plc, "asyncua_client.py", &["s7200", &port, &certificates])
}

/// Analog inputs are input registers, and analog outputs holding registers.
pub fn registers() -> Result<(), Failed> {
    let (folder, port) = (tempfile::tempdir()?, free_port());
    std::fs::write(
        folder.path().join("plc.toml"),
        "cpu = \"224XP\"\n[services.registers]\ninput_registers = \"AIW0\"\nholding_registers = \"AQW0\"\n",
    )?;
    std::fs::write(
        folder.path().join("main.awl"),
        "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNETWORK 1\nLD SM0.0\n= Q0.0\nEND_ORGANIZATION_BLOCK\n",
    )?;
    let out = folder.path().join("s7200");
    process::plcc(&["build", "--quiet"], &[folder.path()], &out)?;
    let plc = Plc::run(&out, &["--modbus", &port.to_string(), "--set", "AIW2=1234"])?;
    process::write_register(&port.to_string(), 0x1234)?;
    // Function, first register, and the answer from the function on.
    for (function, first, expected) in [(4, 1, [4, 2, 0x04, 0xD2]), (3, 0, [3, 2, 0x12, 0x34])] {
        let answer = asks(port, &[&[0, 1, 0, 0, 0, 6, 1, function, 0, first, 0, 1]])?;
        if !answer.ends_with(&expected) {
            return Err(format!("function {function} is answered with {answer:02X?}").into());
        }
    }
    plc.end().map(drop)
}
