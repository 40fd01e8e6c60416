"""The templates of docs/farm.md for OpenJD and OpenCue: farm_templates.py FARM.md FOLDER SCENE FIELD.olx

Checks that both are well formed and refer to nothing that they do not define, then runs their commands in FOLDER, on a quick scene: all
tasks of the first step at once, then the second. Each must make FIELD.olx, byte for byte."""
import json
import os
import re
import shlex
import subprocess
import sys
import xml.etree.ElementTree as ElementTree


def block(page, language, first):
    return re.search(r"```%s\n(%s.*?)```" % (language, re.escape(first)), page, re.S).group(1)


def tasks_of(text):
    first, last = text.split("-") if "-" in text else (text, text)
    return range(int(first), int(last) + 1)


def openjd_commands(template):
    """For each step a list of commands."""
    if template["specificationVersion"] != "jobtemplate-2023-09" or set(template) - {"specificationVersion", "name", "parameterDefinitions", "steps"}:
        sys.exit("OpenJD: not a job template")
    values = {"Param." + p["name"]: p["default"] for p in template["parameterDefinitions"]}
    # Reference tools refuse absolute defaults of the type PATH.
    if any(p["type"] != "STRING" for p in template["parameterDefinitions"]):
        sys.exit("OpenJD: a parameter is no string")
    seen = []
    for step in template["steps"]:
        if set(step) - {"name", "dependencies", "parameterSpace", "script"}:
            sys.exit("OpenJD: a step with more than it may have: %s" % list(step))
        if [d["dependsOn"] for d in step.get("dependencies", [])] != seen[-1:]:
            sys.exit("OpenJD: the steps do not follow each other")
        seen.append(step["name"])
        parameters = step.get("parameterSpace", {"taskParameterDefinitions": []})["taskParameterDefinitions"]
        commands, action = [], step["script"]["actions"]["onRun"]
        for number in tasks_of(parameters[0]["range"]) if parameters else [0]:
            known = dict(values, **{"Task.Param." + p["name"]: str(number) for p in parameters})
            commands.append([re.sub(r"{{([^}]*)}}", lambda found: known[found.group(1)], word) for word in [action["command"], *action["args"]]])
        yield commands


def opencue_commands(spec):
    layers = {layer.get("name"): layer for layer in spec.iter("layer")}
    depend = spec.find("depends/depend")
    jobs = [job.get("name") for job in spec.iter("job")]
    if depend.get("type") != "LAYER_ON_LAYER" or [depend.findtext("depjob"), depend.findtext("onjob")] != 2 * jobs:
        sys.exit("OpenCue: the dependency names no job of the file")
    for name in depend.findtext("onlayer"), depend.findtext("deplayer"):
        layer = layers.pop(name)
        yield [layer.findtext("cmd").replace("#IFRAME#", str(frame)).split() for frame in tasks_of(layer.findtext("range"))]
    if layers:
        sys.exit("OpenCue: layers that nothing depends on: %s" % list(layers))


def read(path):
    with open(path, "rb") as file:
        return file.read()


def check(name, steps, folder, wanted):
    for commands in steps:
        started = [subprocess.Popen([word.replace("/shared", folder) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
                   for command in commands]
        for process in started:
            errors = process.communicate()[1]
            if process.returncode != 0:
                sys.exit("%s: exit code %d: %s" % (name, process.returncode, errors.decode()))
    field = os.path.join(folder, "temple.olx")
    if read(field) != wanted:
        sys.exit("%s: another field" % name)
    os.remove(field)


def main(path, folder, scene, wanted):
    with open(path, encoding="utf-8") as file:
        page = file.read()
    script = block(page, "sh", "#!/usr/bin/env bash\n# part.sh")
    for old, new in (("builtin:temple --grid 8x8x8", scene), ("sleep 10", "sleep 0.1"), ("/shared", shlex.quote(folder)),
                     ("--threads 4", "--threads 1")):
        if old not in script:
            sys.exit("part.sh has no '%s'" % old)
        script = script.replace(old, new)
    with open(os.path.join(folder, "part.sh"), "w", encoding="utf-8") as file:
        file.write(script)
    # Fewer tasks than a farm has: three, instead of sixteen.
    fewer = lambda text: text.replace('"16"', '"3"').replace("1-16", "1-3").replace("# 16<", "# 3<")
    check("OpenJD", openjd_commands(json.loads(fewer(block(page, "json", "{")))), folder, read(wanted))
    check("OpenCue", opencue_commands(ElementTree.fromstring(fewer(block(page, "xml", "<?xml")))), folder, read(wanted))
    os.remove(os.path.join(folder, "part.sh"))


main(*sys.argv[1:])
