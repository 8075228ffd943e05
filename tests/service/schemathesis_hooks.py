"""What Schemathesis is told about the service beyond its description.

Random ids name nothing: well-formed ones stand for a session and an operation that exist (TRUESTEP_SESSION, TRUESTEP_OPERATION)
but where it follows links to what it made itself.
A key that was used before answers as it did then, also when the session of that answer has been deleted since: each is new.
Requests that would keep a session busy are made small: it looks for faults, not for how long a billion steps take.
"""
import os
import re
import uuid

import schemathesis

ID = re.compile(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}")
STAND_INS = {"/v1/sessions/{id}": "TRUESTEP_SESSION", "/v1/operations/{id}": "TRUESTEP_OPERATION"}
MOST = {"steps": 50, "step": 50, "seconds": 0.1, "until": 0.1, "time": 0.1}


@schemathesis.hook
def before_call(context, case, kwargs):
    linked = case.meta is not None and case.meta.phase.name == "stateful"
    for path, variable in STAND_INS.items():
        if linked:
            break
        given = (case.path_parameters or {}).get("id")
        if case.path.startswith(path) and case.method not in ("DELETE", "PUT") and isinstance(given, str) and ID.fullmatch(given):
            case.path_parameters["id"] = os.environ[variable]
    if isinstance(case.body, dict) and case.path.endswith(("/step", "/seek")):
        for name, most in MOST.items():
            value = case.body.get(name)
            if isinstance(value, (int, float)) and not isinstance(value, bool) and value > most:
                case.body[name] = most
    headers = case.headers or {}
    if re.fullmatch("[!-~]{1,255}", headers.get("Idempotency-Key", "")):
        case.headers["Idempotency-Key"] = uuid.uuid4().hex
    wait = (case.query or {}).get("wait")
    if isinstance(wait, (int, float)) and wait > 0.1:
        case.query["wait"] = 0.1
