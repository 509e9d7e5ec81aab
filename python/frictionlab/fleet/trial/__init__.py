"""How well fleets are judged, on fleets whose truth is known.

``python -m frictionlab.fleet.trial drift`` tells how soon a change is found and how often wrongly, and
``python -m frictionlab.fleet.trial engines`` what an engine costs a recording. Both print a table.
"""
