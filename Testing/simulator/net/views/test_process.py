"""The view server as a user starts it: in the simulator's process, by the command."""

from concurrent.futures import ThreadPoolExecutor

from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.simulator.net.views.served import ViewClient, request


def test_a_view_pairs_by_the_printed_code_and_does_not_keep_the_simulator_from_ending(
    tmp_path, loop_thread
):
    with ViewedSimulator(tmp_path / "records", "--view-port", "0") as simulator:
        status, headers, _ = request(simulator.url, "/pair", "POST", json={"code": simulator.code})
        assert status == 200
        key = headers["Set-Cookie"].split(";")[0].partition("=")[2]
        with ViewClient(loop_thread, simulator.url, key) as view:
            assert view.join()["protocol"] == 1
            assert view.next("screen")["screen"]["menu"]["name"] == "start"
            first, second = view.next("state"), view.next("state")
            assert second["tick"] > first["tick"]
            view.send("{")
            assert view.closing()[0] == 1008
        with ViewClient(loop_thread, simulator.url, key) as again, ThreadPoolExecutor() as reading:
            assert again.join()["view"] == 2
            scene = again.next("scene")["url"]
            headers = {"Authorization": f"Bearer {key}"}
            assert request(simulator.url, scene, headers=headers)[2][:4] == b"glTF"
            # It reads all the time: the simulator waits only briefly for peers that do not.
            closing = reading.submit(again.closing)
            status, errors = simulator.stop()
            assert closing.result() == (1001, "The simulator has been stopped.")
        assert status == 0
        assert key not in errors
        assert simulator.code not in errors
