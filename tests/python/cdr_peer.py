"""Fills messages by a rule that the other side knows too, and compares bytes.

usage: cdr_peer.py < {"package/msg/Type": "bytes in hexadecimal", ...}

For each type prints, in hexadecimal: `filled`, the bytes of a message filled here; `returned`, the given bytes read and written again. The rule:
every primitive in order has the next number n, from 1. A boolean is n odd; an integer n; a float n + 0.25, negative where n is even; a
string `text n ü`; a sequence has two elements.
"""

import importlib
import json
import re
import sys

from rclpy.serialization import deserialize_message, serialize_message

PARTS = ("Request", "Response", "Goal", "Result", "Feedback")


def kind(name: str):
    package, folder, name = name.split("/")
    name, _, part = name.partition("_")
    found = getattr(importlib.import_module(f"{package}.{folder}"), name)
    return getattr(found, part) if part in PARTS else found


class Fill:
    def __init__(self) -> None:
        self.number = 0

    def value(self, type_name: str):
        if sequence := re.fullmatch(r"sequence<(.*)>", type_name):
            return [self.value(sequence[1]) for _ in range(2)]
        if "/" in type_name:
            package, name = type_name.split("/")
            return self.message(getattr(importlib.import_module(f"{package}.msg"), name))
        self.number += 1
        n = self.number
        if type_name == "boolean":
            return n % 2 == 1
        if type_name == "double":
            return (n + 0.25) * (1 if n % 2 == 1 else -1)
        if type_name == "string":
            return f"text {n} ü"
        if type_name == "octet":
            return bytes([n % 256])
        return n

    def message(self, found):
        fields = found.get_fields_and_field_types()
        return found(**{name: self.value(type_name) for name, type_name in fields.items()})


def main() -> None:
    answer = {}
    for name, given in json.load(sys.stdin).items():
        found = kind(name)
        returned = serialize_message(deserialize_message(bytes.fromhex(given), found))
        answer[name] = {"filled": serialize_message(Fill().message(found)).hex(), "returned": returned.hex()}
    print(json.dumps(answer))


if __name__ == "__main__":
    main()
