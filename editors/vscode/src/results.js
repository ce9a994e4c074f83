// What `plcc test --json` says, and where assertions stand. Nothing here needs an editor.
"use strict";

const path = require("node:path");

/** The 0-based lines of assertions in a text. */
function assertions(text) {
  const lines = text.split(/\r?\n/);
  return lines.flatMap((line, at) => (/^\s*\/\/@\s*assert\b/.test(line) ? [{ line: at, text: line.trim().slice(3).trim() }] : []));
}

/**
 * What became of each assertion of a file.
 *
 * `report` is the object that plcc prints, `places` are those of `assertions`, `same` tells whether a name in the report is the
 * file. Without a compiled program nothing ran: `state` is then "errored".
 */
function outcomes(report, places, same) {
  const broken = report.tests.find((test) => !test.compiled);
  if (broken) {
    return places.map((place) => ({ ...place, state: "errored", message: broken.messages || broken.text }));
  }
  const failures = report.tests.flatMap((test) => test.failures).filter((failure) => same(failure.file));
  // Assertions that no cycle reached are in the text only: `FAILED file:line: ...` and `was never executed`.
  const missed = report.tests.flatMap((test) => [...test.text.matchAll(/^FAILED (.+):(\d+): .*\n\s+was never executed/gm)]);
  return places.map((place) => {
    const failure = failures.find((one) => one.line === place.line + 1);
    if (failure) {
      const when = failure.cycle == null ? "" : ` in cycle ${failure.cycle}`;
      const message = `found ${failure.found}, expected ${failure.expected}${when}`;
      return { ...place, state: "failed", message, found: String(failure.found), expected: String(failure.expected) };
    }
    if (missed.some((match) => same(match[1]) && Number(match[2]) === place.line + 1)) {
      return { ...place, state: "failed", message: "was never executed" };
    }
    return { ...place, state: "passed" };
  });
}

/** Whether two names are one file, the first seen from a folder. */
function sameFile(folder, name, file) {
  return path.resolve(folder, name) === path.resolve(file);
}

/** The commands in what `plcc --help` prints. */
function commands(help) {
  const list = help.split(/^Commands:$/m)[1] ?? "";
  return [...list.matchAll(/^ {2}([a-z]+)/gm)].map((match) => match[1]);
}

module.exports = { assertions, outcomes, sameFile, commands };
