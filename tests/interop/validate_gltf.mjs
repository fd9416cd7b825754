// Runs Khronos's glTF validator. usage: node validate_gltf.mjs FILE… Prints one JSON array with an
// entry per file: {file, errors, warnings, messages, animations, morphs}.

import { readFile } from "node:fs/promises";
import path from "node:path";

import validator from "gltf-validator";

const reports = [];
for (const file of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: path.basename(file),
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(path.join(path.dirname(file), decodeURIComponent(uri)))),
  });
  reports.push({
    file,
    errors: report.issues.numErrors,
    warnings: report.issues.numWarnings,
    messages: report.issues.messages
      .filter((message) => message.severity < 2)
      .map((message) => `${message.code} ${message.pointer}: ${message.message}`),
    infos: [...new Set(report.issues.messages.map((message) => message.code))],
    animations: report.info.animationCount,
    morphs: report.info.hasMorphTargets,
    external: (report.info.resources ?? []).map((resource) => resource.uri),
  });
}
console.log(JSON.stringify(reports));
