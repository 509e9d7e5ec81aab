"""Prints the type hashes that ROS itself generated for the given types (`package/msg/Type`, `package/srv/Type_Request` ...), as JSON."""

import json
import sys
from pathlib import Path

hashes = {}
for name in sys.argv[1:]:
    package, folder, kind = name.split("/")
    # A part of a service or an action stands in the file of the whole.
    whole = kind.partition("_")[0]
    file = Path(sys.prefix) / "share" / package / folder / f"{whole}.json"
    generated = json.loads(file.read_text(encoding="utf-8"))
    [hashes[name]] = [entry["hash_string"] for entry in generated["type_hashes"] if entry["type_name"] == name]
print(json.dumps(hashes))
