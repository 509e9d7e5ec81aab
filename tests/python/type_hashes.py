"""Prints the type hashes that ROS itself generated for the given types (`package/msg/Type ...`), as JSON."""

import json
import sys
from pathlib import Path

hashes = {}
for name in sys.argv[1:]:
    package, _, kind = name.split("/")
    file = Path(sys.prefix) / "share" / package / "msg" / f"{kind}.json"
    generated = json.loads(file.read_text(encoding="utf-8"))
    [hashes[name]] = [entry["hash_string"] for entry in generated["type_hashes"] if entry["type_name"] == name]
print(json.dumps(hashes))
