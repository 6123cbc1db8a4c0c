#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes every surface and tet mesh of the data set and writes a table of how each ended.

    mesh_survey.py SOUPLE [--tets 10000] [--jobs 2] [--only NAME...] [--table FILE]

Each file gets 120 s and 4 GiB. Sums are printed as rows of the scoreboard on stdout, the table goes to
FILE (default: mesh_survey.md in $BENCH_TMP or the working folder) and, line by line, to stderr. What
truly has no volume stands in mesh_survey_refused.txt with the code it must be refused with.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
SECONDS, BYTES = 120, 4 << 30
# Parts of other files, or no meshes at all.
SKIPPED_SUFFIXES = {".bin", ".node", ".md", ".txt"}


def data_folder():
    default = HERE.parent.parent.parent / "shared" / "data"
    return pathlib.Path(os.environ.get("SOUPLE_DATA_DIR", default))


def refused_list():
    """File name -> code, of what has no volume or is damaged on purpose."""
    codes = {}
    for line in (HERE / "mesh_survey_refused.txt").read_text(encoding="utf-8").splitlines():
        line = line.split("#")[0].strip()
        if line:
            name, code = line.rsplit(None, 1)
            codes[name] = code
    return codes


def limits():
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))


def run(words):
    """(exit code or None after the time limit, stdout, stderr, seconds)"""
    begin = time.monotonic()
    try:
        done = subprocess.run(words, capture_output=True, timeout=SECONDS, preexec_fn=limits, check=False)
        code, out, err = done.returncode, done.stdout, done.stderr
    except subprocess.TimeoutExpired:
        code, out, err = None, b"", b""
    return code, out.decode(errors="replace"), err.decode(errors="replace"), time.monotonic() - begin


def parsed(text):
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return None


def bake(souple, file, tets, asset, extra=()):
    words = [souple, "bake", str(file), "--size-m", "0.2", "-o", asset, "--json", "--quiet", *extra]
    if file.parent.name == "surfaces":
        words += ["--tets", str(tets)]
    return run(words)


def survey_one(souple, file, tets):
    with tempfile.TemporaryDirectory() as folder:
        asset = os.path.join(folder, "a.souple")
        code, out, err, seconds = bake(souple, file, tets, asset)
        report = parsed(out)
        mended = False
        if report and report.get("issue", {}).get("code") in ("S3041", "S3042", "S3043"):
            code, out, err, more = bake(souple, file, tets, asset, ("--repair", "mend"))
            report, seconds, mended = parsed(out), seconds + more, True
        result = {"file": file.name, "kind": file.parent.name, "seconds": seconds, "report": report,
                  "mended": mended, "left_behind": os.listdir(folder)}
        if code is None:
            result["outcome"] = "hang"
        elif code < 0:
            result["outcome"] = f"crash (signal {-code})"
        elif code == 0 and report:
            valid = run([souple, "validate", "-q", asset])[0]
            result["outcome"] = "asset" if valid == 0 else "asset that is not valid"
        elif report and "issue" in report:
            result["outcome"] = report["issue"]["code"]
        else:
            result["outcome"] = f"uncoded exit {code}: {err.strip()[-120:]}"
        return result


def stage(result, name):
    report = result["report"]
    return (report or {}).get(name) or {}


def diagonal(report):
    box = report["box_m"]
    return sum((b - a) ** 2 for a, b in zip(box["min"], box["max"])) ** 0.5


def cells(result):
    repair, coarse, report = stage(result, "repair"), stage(result, "coarse_mesh"), result["report"]
    is_asset = result["outcome"] == "asset"
    levels = report["levels"] if is_asset else []
    return [
        result["file"],
        (repair.get("before") or {}).get("grade", "-"),
        "; ".join(f"{a['name']} {a['count']}" for a in repair.get("actions", [])) or "-",
        coarse.get("mesher", "given" if is_asset else "-"),
        "kept" if coarse.get("features", {}).get("kept") else "-",
        " / ".join(str(level["tet_count"]) for level in levels) or "-",
        " / ".join(f"{level['min_dihedral_deg']:.1f}" for level in levels) or "-",
        " / ".join(f"{level['worst_radius_ratio']:.3f}" for level in levels) or "-",
        f"{100 * repair['moved']['hausdorff_m'] / diagonal(report):.3f}" if is_asset and repair else "-",
        f"{100 * levels[-1]['distance']['hausdorff_m'] / diagonal(report):.3f}" if levels else "-",
        f"{result['seconds']:.1f}",
        f"{report['peak_memory_bytes'] / 1e6:.0f}" if is_asset else "-",
        result["outcome"] + (" (mended on request)" if result["mended"] else ""),
    ]


HEADINGS = ["file", "grade", "actions", "mesher", "sharp edges", "tets per level", "min dihedral deg",
            "worst radius ratio", "repair moved, % of diagonal", "two-sided Hausdorff, % of diagonal",
            "seconds", "peak MB", "outcome"]


def table(results):
    lines = ["| " + " | ".join(HEADINGS) + " |", "|" + "---|" * len(HEADINGS)]
    lines += ["| " + " | ".join(cells(result)) + " |" for result in results]
    return "\n".join(lines) + "\n"


def print_row(name, value, unit, runs):
    print(f"row survey.{name} value={value:.6g} unit={unit} runs={runs}")


def is_bad(result):
    return not (result["outcome"] == "asset" or result["outcome"].startswith("S"))


def rows(results):
    refused = refused_list()
    assets = [r for r in results if r["outcome"] == "asset"]
    print_row("files", len(results), 1, 1)
    print_row("assets", len(assets), 1, len(results))
    print_row("bad_ends", sum(map(is_bad, results)), 1, len(results))
    print_row("volume_refused", sum(r["outcome"].startswith("S") and r["file"] not in refused
                                    for r in results), 1, len(results))
    print_row("no_volume_otherwise", sum(r["file"] in refused and r["outcome"] != refused[r["file"]]
                                         for r in results), 1, len(results))
    print_row("seconds_largest", max(r["seconds"] for r in results), "s", len(results))
    print_row("seconds_median", statistics.median(r["seconds"] for r in results), "s", len(results))
    meshed = [r for r in assets if stage(r, "coarse_mesh")]
    print_row("lattice", sum(stage(r, "coarse_mesh")["mesher"] == "lattice" for r in meshed), 1, len(meshed))
    if not meshed:
        return
    print_row("peak_memory_largest", max(r["report"]["peak_memory_bytes"] for r in assets) / 1e6, "MB",
              len(assets))
    for name, kept in (("smooth", False), ("features", True)):
        angles = [stage(r, "coarse_mesh")["quality"]["min_dihedral_deg"] for r in meshed
                  if bool(stage(r, "coarse_mesh")["features"]["kept"]) == kept]
        if angles:
            print_row(f"coarse_dihedral_{name}", min(angles), "deg", len(angles))
            limit = 5 if kept else 10
            print_row(f"coarse_dihedral_{name}_below", sum(a < limit for a in angles), 1, len(angles))
    print_row("coarse_worst_aspect", max(stage(r, "coarse_mesh")["quality"]["worst_aspect"]
                                         for r in meshed), 1, len(meshed))
    finer = [level["children"] for r in meshed for level in r["report"]["levels"][1:]]
    if finer:
        print_row("children_keeping_70_least", 100 * min(c["share_keeping_70"] for c in finer), "%", len(finer))
        print_row("children_keeping_70_median",
                  100 * statistics.median(c["share_keeping_70"] for c in finer), "%", len(finer))
        print_row("children_worst_kept", min(c["worst_kept"] for c in finer), 1, len(finer))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("souple")
    parser.add_argument("--tets", type=int, default=10000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--table")
    given = parser.parse_args()
    data = data_folder()
    files = sorted(f for kind in ("surfaces", "tets") for f in (data / kind).iterdir()
                   if f.suffix.lower() not in SKIPPED_SUFFIXES and f.is_file())
    if given.only:
        files = [f for f in files if f.name in given.only]
    if not files:
        sys.exit(f"no files in {data}; set SOUPLE_DATA_DIR")
    results = []
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        for result in pool.map(lambda f: survey_one(given.souple, f, given.tets), files):
            results.append(result)
            print(" | ".join(cells(result)), file=sys.stderr, flush=True)
    target = pathlib.Path(given.table or os.path.join(os.environ.get("BENCH_TMP", "."), "mesh_survey.md"))
    target.write_text(table(results), encoding="utf-8")
    print(f"table: {target}", file=sys.stderr)
    rows(results)


if __name__ == "__main__":
    main()
