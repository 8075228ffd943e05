"""Wrong answers, one or more per service test: which answer is altered and how. control_test.py expects the test to fail."""
import itertools
import json
import re


def answer(pattern, change):
    """Alters every HTTP answer whose "METHOD path" matches: `change` gets the Answer."""
    return "http", re.compile(pattern), change


def body(pattern, change):
    """Alters the JSON of those answers: `change` gets the object."""
    def apply(a):
        if a.status == 204 or not a.body.lstrip().startswith((b"{", b"[")):
            return
        value = json.loads(a.body)
        change(value)
        a.body = json.dumps(value).encode()
    return answer(pattern, apply)


def message(kind, change):
    """Alters every stream message of this kind: `change` gets the message."""
    return "stream", kind, change


def output(change):
    """Alters what the program gave: `change` gets the CompletedProcess."""
    return "program", None, change


def growing_estimates():
    """Estimates of each scene a hundred times those of the one before."""
    calls = itertools.count()

    def apply(p):
        report = json.loads(p.stdout)
        report["estimate"]["seconds_per_step"] *= 100.0 ** next(calls)
        p.stdout = json.dumps(report)
    return output(apply)


def put(key, value):
    return lambda o: o.update({key: value})


def status(value):
    return lambda a: setattr(a, "status", value)


def text(old, new):
    return lambda a: setattr(a, "body", a.body.replace(old, new))


def nudge(o):
    if "blocks" in o:
        o["blocks"][0]["values"][0][0] += 1e-7


numbers = itertools.count()


def another_hash(o):
    if "state_hash" in o:
        o["state_hash"] = "%016x" % next(numbers)


def shift_scale(m):
    for block in m["blocks"]:
        if block["encoding"].startswith("Q16"):
            block["offset"] = [x + 0.7 * q for x, q in zip(block["offset"], block["scale"])]


def stdout(old, new):
    return lambda p: setattr(p, "stdout", p.stdout.replace(old, new))


STEP, SELF, FRAMES = r"POST .*/step$", r"GET /v1/sessions/[^/]+$", r"GET .*/frames"

ALTERED = {
    "equations_test.Equations": {
        "test_a_scene_of_text_steps_streams_and_draws": [body(FRAMES, put("state_hash", "0"))],
        "test_commands_set_parameters_and_the_journal_repeats_them": [body("POST .*/seek$", another_hash)],
        "test_faults_name_the_text_and_the_place": [body("POST /v1/sessions$", lambda o: o["errors"].clear())],
        "test_texts_that_expand_without_bound_are_refused_fast": [answer("POST /v1/sessions$", status(201))],
        "test_a_run_that_explodes_names_the_state": [body(STEP, put("system", "other"))],
    },
    "sessions_test.Sessions": {
        "test_create_answers_with_location_and_links": [body("POST /v1/sessions$", lambda o: o["links"].pop("picture"))],
        "test_damped_oscillator_through_http": [body(FRAMES, nudge)],
        "test_from_step_is_a_precondition": [body(SELF, put("step", 10))],
        "test_idempotency_key_repeats_the_answer_not_the_step": [body(SELF, put("step", 6))],
        "test_create_under_the_clients_own_id": [answer("PUT", lambda a: a.status == 409 and status(200)(a))],
        "test_pages_of_sessions": [body("GET /v1/sessions.page_token=|GET /v1/sessions.limit", lambda o: o["sessions"].clear())],
        "test_deleted_sessions_are_unknown": [body(SELF, put("code", "ok"))],
        "test_play_pause_reset": [body("POST .*/reset$", put("step", 1))],
        "test_snapshot_restore_and_branch_continue_the_trajectory": [body(STEP, another_hash)],
        "test_the_scene_of_a_session_makes_the_same_session_again": [body("GET .*/scene$", lambda o: o["systems"][0].update(stiffness=1))],
        "test_a_branch_keeps_the_method_that_was_chosen": [body("POST .*/branch$", lambda o: o["accuracy"].update(tolerance=1))],
        "test_seek_is_exact": [body("POST .*/seek$", put("state_hash", "0" * 16))],
        "test_instability_says_where_and_what_would_have_held": [body(STEP, put("suggested_dt", 2.001e-3))],
    },
    "output_test.Output": {
        "test_poll_and_long_poll": [body(FRAMES, lambda o: o["frames"][1:2] and o["frames"].pop(4))],
        "test_frames_nobody_asked_for_are_not_built": [body(SELF, put("frames_built", 1))],
        "test_protobuf_frame": [answer(FRAMES, text(b"\x00\x00\x80\x3f", b"\x01\x00\x80\x3f"))],
        "test_earlier_frames_are_exact": [body(FRAMES, put("state_hash", "0" * 16))],
        "test_observables_as_json_and_csv": [body("GET .*/observables", lambda o: o["series"]["values"]["energy.total"].__setitem__(0, 50 + 1e-11))],
        "test_plan_names_passes_and_what_was_skipped": [body("GET .*/plan", lambda o: o["passes"][-1].update(reason=""))],
        "test_motion_of_a_skeleton_as_bvh_and_gltf": [answer("GET .*seconds=0.3", text(b"Frames: 4", b"Frames: 5"))],
        "test_picture_is_a_png_of_the_wanted_size": [answer("GET .*width=320", text(b"\x00\x00\x01\x40", b"\x00\x00\x01\x41"))],
        "test_recording_is_refused_while_written_and_served_afterwards": [answer("GET .*/recording", lambda a: a.status == 206 and text(b"\x89", b"\x88")(a))],
        "test_recording_ends_by_itself_at_the_scenes_duration": [answer("GET .*/recording", status(409))],
    },
    "catalogue_test.Catalogue": {
        "test_every_system_is_described": [body("GET /v1/systems/", lambda o: o["parameters"].clear())],
        "test_every_gallery_scene_is_valid_and_says_what_it_teaches": [body("GET /v1/gallery/", lambda o: o["expect"][0].pop("source"))],
        "test_all_faults_of_a_scene_at_once": [body("POST /v1/sessions$", lambda o: o["errors"].pop())],
        "test_unknown_keys_hide_no_names_that_nobody_knows": [body("POST /v1/sessions$", lambda o: o["errors"].pop())],
        "test_units_are_echoed_in_si": [body("POST .*/validate", lambda o: o["scene"]["systems"][0].update(mass=250))],
        "test_descriptions": [body("GET /openapi.json", lambda o: o["paths"].pop("/v1/gallery"))],
        "test_health_and_metrics": [answer("GET /metrics", text(b"truestep_sessions ", b"sessions "))],
        "test_bad_requests": [answer("POST .*/seek", status(200))],
    },
    "stream_test.Stream": {
        "test_hello_topology_playback_frame": [message("hello", put("session", "another"))],
        "test_a_grid_is_a_part_with_its_lattice_and_streams_unasked": [message("hello", lambda m: m["parts"][0].update(kind="points"))],
        "test_parts_beside_the_main_one_are_asked_for_by_their_names": [message("hello", lambda m: m["parts"].pop())],
        "test_credit_bounds_the_frames_in_flight_and_gaps_are_counted": [message("frame", put("dropped", "0"))],
        "test_every_policy_leaves_no_gap": [message("frame", lambda m: m["step"] == "150" and m.update(step="151"))],
        "test_differences_decode_to_the_positions_within_half_a_quantum": [message("frame", shift_scale)],
        "test_commands_and_control_over_the_stream": [message("problem", put("code", "internal"))],
        "test_unknown_subprotocols_and_foreign_origins_are_refused": [("handshake", None, 101)],
    },
    "watched_test.Series": {
        "test_every_session_keeps_energy_from_the_start": [body("GET .*/observables", lambda o: o["series"]["step"].__setitem__(0, 1))],
        "test_probes_are_kept_and_the_scenes_list_adds_to_them": [body("GET .*/observables", lambda o: o["series"]["values"].pop("energy.total"))],
        "test_it_is_bounded": [body("GET .*/observables", lambda o: o["series"]["step"].extend(range(4000)))],
    },
    "routes_test.Routes": {
        "test_unknown_query_parameters_are_errors_on_every_route": [answer(r"GET /v1/gallery.nonsense", status(200))],
        "test_it_names_what_is_allowed_and_the_nearest": [body("colour_by", lambda o: o["errors"][0].update(did_you_mean="camera"))],
        "test_a_picture_is_drawn_as_told": [body("color_by=strian", lambda o: o["errors"][0].update(did_you_mean="speed"))],
        "test_queries": [body("POST .*/queries$", lambda o: [h.update(distance=h["distance"] + 1e-5) for h in o.get("hits", [])])],
        "test_contacts_of_a_body_at_rest": [body("POST .*/queries$", lambda o: [c.update(force=1.1 * c["force"]) for c in o["contacts"]])],
        "test_assets_stand_where_scenes_refer_to_them": [answer("GET /v1/assets/", text(b"2, 1", b"2, 2"))],
        "test_mesh_files_stand_where_scenes_refer_to_them": [answer("GET /v1/assets/", text(b"v 10", b"v 11"))],
        "test_a_run_gives_observables_over_time": [body("GET .*/result$", lambda o: o["summary"].update(state_hash="0" * 16))],
    },
    "round_trip_test.RoundTrip": {
        "test_it_is_what_the_requests_one_by_one_give": [body("POST .*/step", lambda o: o.get("observables", {}).update(x=1))],
        "test_names_choose": [body("POST .*/step", lambda o: o.get("observables", {}).update(x=1))],
        "test_what_is_wrong_anywhere_changes_nothing": [body("POST .*/step", lambda o: o.get("errors") and o["errors"][0].update(pointer="/"))],
        "test_a_command_may_name_what_the_one_before_made": [body("POST .*/commands", lambda o: isinstance(o, list) and o[0].update(step=1))],
        "test_arrays_of_queries": [body("POST .*/queries", lambda o: isinstance(o, list) and o[0]["hits"][0].update(index=5))],
        "test_protobuf": [answer("POST .*/step", text(b'"step":3', b'"step":4'))],
        "test_a_repeated_request_is_carried_out_once": [body("GET /v1/sessions/[^/]*$", put("step", 2))],
        "test_a_run_that_fails_says_so": [answer("POST .*/step", status(200))],
        "test_over_the_stream_as_json": [message("answer", put("request_id", "two"))],
        "test_over_the_stream_as_protobuf": [body("GET /v1/sessions/[^/]*$", put("state_hash", "0" * 16))],
    },
    "queries_test.Queries": {
        # Ten times what a cast may stop short of.
        "test_casts_beside_geometry": [body("POST .*/queries", lambda o: [h.update(distance=h["distance"] + 2e-3) for h in o["hits"]])],
        "test_solids_that_overlap": [body("POST .*/queries", lambda o: o["items"] and o["items"].pop())],
        "test_rows_are_passed_over": [body("POST .*/queries", lambda o: [h.update(index=7) for h in o["hits"]])],
        "test_what_is_wrong_is_named": [body("POST .*/queries", lambda o: o["errors"][0].update(pointer="/"))],
        "test_many_at_once_are_what_each_is": [body("POST .*/queries", lambda o: isinstance(o, list) and o[0].update(step=5))],
    },
    "ending_test.Ending": {
        "test_sigterm_closes_streams_and_finishes_recordings": [output(stdout('"finalized":true', '"finalized":false'))],
        "test_limits_are_answered_with_the_estimate": [body("POST /v1/sessions$", put("code", "internal"))],
        "test_other_machines_need_a_key": [output(lambda p: setattr(p, "returncode", 0))],
    },
    "alike_test.Alike": {
        "test_what_is_valid_runs_and_what_is_not_does_not": [output(lambda p: "validate" in p.args and setattr(p, "returncode", 0))],
        "test_steps_much_shorter_than_the_grid_allows_are_valid": [output(lambda p: "validate" in p.args and setattr(p, "returncode", 3))],
    },
    "estimates_test.Estimates": {
        "test_shorter_steps_of_constraints_have_fewer_substeps_of_their_own": [growing_estimates()],
        "test_points_that_meet_bodies_are_not_factorised": [growing_estimates()],
        "test_larger_bodies_touch_more_of_a_cloth": [growing_estimates()],
        "test_a_stiff_attachment_asks_both_sides_and_a_soft_one_neither": [growing_estimates()],
    },
    "command_line_test.CommandLine": {
        "test_exit_codes": [output(lambda p: p.returncode == 6 and setattr(p, "returncode", 0))],
        "test_run_prints_one_json_object": [output(lambda p: "--threads" in p.args and stdout('"state_hash":"', '"state_hash":"0')(p))],
        "test_validate_lists_faults": [output(stdout("/systems/0/mas", "/systems/0"))],
        "test_time_series": [output(lambda p: "-" == p.args[-1] and stdout("step,", "step,,")(p))],
        "test_unknown_observable_is_refused_with_the_nearest": [output(lambda p: setattr(p, "returncode", 0))],
        "test_a_recording_holds_all_observables_unless_the_scene_names_some": [output(stdout("energy.kinetic", "energy"))],
        "test_states_without_a_place_are_recorded": [output(lambda p: setattr(p, "returncode", 3))],
        "test_descriptions_name_rows_fields_and_observables": [output(stdout("orientation", "turn"))],
        "test_faults_show_values_where_there_are_any": [output(stdout("is required", "is required (got null)"))],
        "test_energy_from_nothing_ends_with_exit_code_4": [output(lambda p: setattr(p, "returncode", 0))],
        "test_remedies_are_those_that_held": [output(stdout("held when tried for", "holds for"))],
        "test_numbers_beyond_all_bounds_end_with_exit_code_4": [output(lambda p: setattr(p, "returncode", 0))],
    },
}
