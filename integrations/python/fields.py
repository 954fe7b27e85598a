#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Make the table of the module's keyword arguments from the library's headers.

    fields.py INCLUDE table    rows in C: the fields of struct hf_params, hf_depth, hf_report and hf_choice
    fields.py INCLUDE stub     the module's .pyi
    fields.py INCLUDE missing  fields whose type the module cannot take; nothing is printed if it takes all

A field that is added to a header is in all of them after the next build. A field keeps its own name, without the unit of a
length at its end: lens.focal_length_mm is focal_length. Fields of an engine and of the highlights carry the name of their
group: gather.storage is gather_storage.
"""
import re
import sys
import textwrap

# Groups whose fields are unlike any others: they need no prefix.
PLAIN = {"", "range", "lens", "aperture", "view", "run"}
# Groups that belong to no engine.
SHARED = PLAIN | {"highlight"}
RENAMED = {"aperture.picture": "aperture", "depth.type": "depth_type", "depth.format": "depth_format"}
# Words of an enum whose family has another name.
FAMILIES = {"layers_quality": "LAYERS"}
TYPES = {"FLOAT": "Number | None", "INT": "Number | None", "NAME": "str | None", "PICTURE": "Pixels | None"}
# What the module does otherwise than the library.
DOCS = {
    "engine": "layers (default), gather, hexagon, scatter, gaussian or chapter.",
    "model": "lens or range: how the blur follows from depth. Default: range if an argument of the range is given (distance, "
             "strength, near_*, far_*), lens if f_number or focal_length is, else range.",
    "depth_format": "Default: by the array's type. d24s8 and x8d24 are stored in uint32.",
}
# Arguments that are no field.
OTHERS = [
    ("transfer", "src.transfer", "NAME", "HF_NAMES_TRANSFER", "transfer", "other",
     "How whole numbers follow from light: srgb (default) or linear. Floats are always linear."),
    ("quality", "quality", "NAME", "HF_NAMES_QUALITY", "quality", "other",
     "Choose the engine and its settings: draft, standard, high or best. It replaces engine and the engines' arguments. "
     "Default: engine layers with its defaults, which is standard."),
    ("max_error", "error", "FLOAT", "0", "max_error", "other",
     "Choose the cheapest engine and settings that are expected to err by no more than this: root mean square distance of "
     "the display-encoded pictures, more than 0, at most 1. Default: not used."),
]


def struct(text, name):
    """The fields of a struct in order: (C type, name, comment)."""
    body = re.search(r"struct " + name + r" \{(.*?)\n\};", text, re.S).group(1)
    comment, fresh = [], False
    for line in body.split("\n"):
        code, _, said = line.partition("//")
        code, said = code.strip(), said.strip()
        if not code:
            if said:
                comment = comment + [said] if fresh else [said]
                fresh = True
            continue
        fresh = False
        own = [said] if said else comment
        match = re.fullmatch(r"(.*?)([a-z_0-9]+(\[\d+\])?(, *[a-z_0-9]+)*);", code)
        if match:
            for field in match.group(2).split(","):
                yield match.group(1).strip(), field.strip(), " ".join(own)


def kind(c_type, enums):
    """The row's kind and the family of its words."""
    if c_type in ("float", "int"):
        return c_type.upper(), "0"
    if c_type == "const struct hf_image *":
        return "PICTURE", "0"
    if c_type.startswith("enum hf_"):
        name = c_type[len("enum hf_"):]
        family = "HF_NAMES_" + FAMILIES.get(name, name.upper())
        if family in enums:
            return "NAME", family
    return None, None


def in_words(comment):
    """A comment of the header as a user of the module reads it: words for enumerators, a capital first."""
    comment = re.sub("HF_DERIVE", "'derive'", comment)
    comment = re.sub(r"HF_(ENGINE|MODEL|STORAGE|FILL|DOWNSAMPLE|DIVISION|BLEND|RESOLUTION|LAYERS|DEPTH_FORMAT|DEPTH)_([A-Z0-9_]+)",
                     lambda found: found.group(2).lower().replace("_", "-"), comment)
    comment = comment[:1].upper() + comment[1:]
    return comment if not comment or comment.endswith(".") else comment + "."


def keyword(group, field):
    path = f"{group}.{field}" if group else field
    if path in RENAMED:
        return RENAMED[path]
    plain = re.sub("_mm?$", "", field)
    return plain if group in PLAIN or group == "depth" else f"{group}_{plain}"


def read(include):
    """Rows (keyword, path, kind, family, member, group, comment), and the paths that no row can hold."""
    params = open(f"{include}/hyperfocal/params.h", encoding="utf-8").read()
    main = open(f"{include}/hyperfocal/hyperfocal.h", encoding="utf-8").read()
    enums = set(re.findall(r"HF_NAMES_\w+", main))
    found = []
    for c_type, field, comment in struct(params, "hf_params"):
        if c_type.startswith("struct hf_"):
            found += [(field, t, f, c) for t, f, c in struct(params, c_type[len("struct "):])]
        else:
            found.append(("", c_type, field, comment))
    found += [("depth", *row) for row in struct(main, "hf_depth") if row[1] not in ("data", "stride")]
    rows, missing = [], []
    for group, c_type, field, comment in found:
        if field == "size" or field.startswith("reserved"):
            continue
        path = f"{group}.{field}" if group else field
        comment = DOCS.get(keyword(group, field), in_words(comment))
        row_kind, family = kind(c_type, enums)
        if row_kind:
            member = path if group == "depth" else "params." + path
            rows.append((keyword(group, field), path, row_kind, family, member, group, comment))
        else:
            missing.append(path)
    rows += OTHERS
    names = [row[0] for row in rows]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        sys.exit(f"fields.py: two fields would be the argument {twice[0]}: give one of them a name in RENAMED")
    return rows, missing, main


def quoted(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def table(rows, main):
    print("// Made by fields.py from the library's headers: do not edit.")
    print("static const struct hfpy_field fields[] = {")
    for name, path, row_kind, family, member, group, comment in rows:
        engine = int(path == "engine" or group not in SHARED | {"depth", "other"})
        print(f'    {{"{name}", "{path}", {quoted(comment)}, FIELD_{row_kind}, {family},\n'
              f'     offsetof(struct hfpy_given, {member}), "{group}", {engine}}},')
    print(f"}};\n_Static_assert(sizeof fields / sizeof fields[0] <= HFPY_MOST_FIELDS, \"{len(rows)} arguments\");")
    for name in ("report", "choice"):
        print(f"static const struct hfpy_number {name}_numbers[] = {{")
        for c_type, field, _ in struct(main, "hf_" + name):
            letter = {"int": "i", "float": "f", "double": "d", "uint64_t": "u"}.get(c_type)
            if letter and not field.startswith("reserved"):
                print(f'    {{"{field}", \'{letter}\', offsetof(struct hf_{name}, {field})}},')
        print("};")


def stub(rows):
    print('"""Depth of field for rendered pictures: see docs/python.md."""')
    print("# Made by fields.py from the library's headers: do not edit.")
    print("from types import TracebackType\nfrom typing import Any, Literal, Union\n")
    print("Number = Union[float, Literal['derive']]")
    print("# What has a buffer: numpy arrays, memoryviews. Or a tuple of 3 or 4 planes.")
    print("Buffer = Any\nPixels = Union[Buffer, tuple[Buffer, ...]]")
    print("__version__: str\nparameters: dict[str, str]\n")
    arguments = ",\n    ".join(f"{name}: {TYPES[row_kind]} = ..." for name, _, row_kind, *_ in rows)
    of_depth = ", ".join(f"{name}: {TYPES[row_kind]} = ..." for name, _, row_kind, _, _, group, _ in rows
                         if group == "depth")
    print(f"def defocus(color: Pixels, depth: Buffer, *, out: Pixels | None = ...,\n    {arguments}) -> Any: ...\n")
    print(f"def coc(depth: Buffer, *, out: Buffer | None = ...,\n    {arguments}) -> Any: ...\n")
    print(f"def depth_at(depth: Buffer, x: int, y: int, *, {of_depth}) -> float: ...\n")
    print(f"def choose_quality(height: int, *,\n    {arguments}) -> tuple[dict[str, Any], dict[str, Any]]: ...\n")
    print("class Context:")
    body = f"""
        def __init__(self, threads: int = ..., isa: str = ...) -> None: ...
        def defocus(self, color: Pixels, depth: Buffer, *, out: Pixels | None = ...,
            {arguments.replace(chr(10), chr(10) + ' ' * 8)}) -> Any: ...
        def cancel(self) -> None: ...
        def close(self) -> None: ...
        def __enter__(self) -> Context: ...
        def __exit__(self, kind: type[BaseException] | None, value: BaseException | None,
            trace: TracebackType | None) -> None: ...
        @property
        def report(self) -> dict[str, float]: ...
        @property
        def threads(self) -> int: ...
        @property
        def isa(self) -> str: ..."""
    print(textwrap.indent(textwrap.dedent(body), "    "))


def run(include, what):
    rows, missing, main = read(include)
    if what == "table":
        table(rows, main)
    elif what == "stub":
        stub(rows)
    elif missing:
        print("\n".join(missing))


if __name__ == "__main__":
    run(*sys.argv[1:])
