#!/usr/bin/env python3
"""A second reader of Lightwell containers, in Python, independent of the library.

  lwc.py list FILE                 sections and chunks
  lwc.py check FILE                all checksums and all rules; exit 4 and the first breach when it is damaged or too new
  lwc.py header FILE SECTION       the section's header as JSON
  lwc.py values FILE SECTION       what the numbers of the section stand for, chunk by chunk, as JSON
  lwc.py dump FILE SECTION/CHUNK   the decoded elements, little-endian, on stdout
"""
import json
import sys

from container import CODEC_NAMES, Container, ContainerError, ELEMENT_NAMES
from decoded import decoded
from messages import HEADERS, parse
from sections import check


def listed(container):
    name = lambda names, value: names[value] if value < len(names) else str(value)
    for section in container.sections.values():
        print(f"{section.type} version {section.version}{' required' if section.required else ''}{'' if section.known else ' (of a later version)'}")
        for chunk in section.chunks.values():
            print(f"  {chunk.name:24} {name(ELEMENT_NAMES, chunk.element):7} {str(chunk.shape):16} {name(CODEC_NAMES, chunk.codec):18} {chunk.stored_bytes} of {chunk.raw_bytes} bytes")


def main(arguments):
    if len(arguments) not in (2, 3) or arguments[0] not in ("list", "check", "header", "values", "dump") or (len(arguments) == 3) != (arguments[0] in ("header", "values", "dump")):
        print(__doc__, file=sys.stderr)
        return 2
    try:
        with open(arguments[1], "rb") as file:
            container = Container(file.read())
        if arguments[0] == "list":
            listed(container)
        elif arguments[0] == "check":
            for note in check(container):
                print(f"note: {note}")
        elif arguments[0] == "values":
            check(container)
            print(json.dumps(decoded(container, arguments[2])[1], indent=1))
        else:
            section, _, name = arguments[2].partition("/")
            chunk = container.sections[section].chunks[name or "header"]
            if arguments[0] == "header":
                print(json.dumps(parse(HEADERS[section], container.decode(chunk)), indent=1))
            else:
                sys.stdout.buffer.write(container.decode(chunk))
    except ContainerError as error:
        print(f"{arguments[1]}: {error}", file=sys.stderr)
        return 4
    except KeyError as error:
        print(f"{arguments[1]} has no {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
