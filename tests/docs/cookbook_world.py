# SPDX-License-Identifier: Apache-2.0
"""What docs/grpcurl.md asks about: map `town`, in which anna and bert have driven, and anna is still connected. One of anna's
closures contradicts the others."""
import contextlib
import math
import queue
import sys
import threading

KEYFRAMES = 40
TIMEOUT_S = 60


class World:
    def __init__(self, channel):
        from overtone.v1 import map_admin_service_pb2_grpc, mapping_service_pb2_grpc
        self.mapping = mapping_service_pb2_grpc.MappingServiceStub(channel)
        self.admin = map_admin_service_pb2_grpc.MapAdminServiceStub(channel)

    def build(self):
        """Returns when the newest revision holds all of it."""
        from overtone.v1 import graph_pb2, map_admin_service_pb2
        import corrected_trajectory as example
        for robot in ("anna", "bert"):
            mission = graph_pb2.MissionId(robot=robot, mission="run")
            closures = [self.closure(mission, i, mission, KEYFRAMES - i, 0) for i in (1, 3, 4)]
            if robot == "anna":
                closures.append(self.closure(mission, 2, mission, KEYFRAMES - 2, 1.5))  # not where the others say
            else:
                anna = graph_pb2.MissionId(robot="anna", mission="run")
                closures += [self.closure(anna, i, mission, i, 0) for i in (5, 12, 19, 26)]
            submaps = example.make_submaps(circle(), closures, drift=0.05, turn_drift_rad=math.radians(1))
            example.upload(self.mapping, "town", mission, submaps)
        deadline = threading.Event()
        for _ in range(TIMEOUT_S * 20):
            closures = self.admin.ListLoopClosures(map_admin_service_pb2.ListLoopClosuresRequest(map="town")).loop_closures
            summary = self.admin.ListMaps(map_admin_service_pb2.ListMapsRequest()).maps[0]
            pending = [c for c in closures if c.verdict == map_admin_service_pb2.LOOP_CLOSURE_VERDICT_PENDING]
            if len(closures) == 11 and not pending and summary.keyframes == 2 * (KEYFRAMES + 1):
                return
            deadline.wait(0.05)  # the server says so only when it is asked
        raise RuntimeError("the map does not settle")

    def report(self, robot, bytes_waiting):
        """As the robot's client does by itself."""
        from overtone.v1 import constraint_pb2, graph_pb2, mapping_service_pb2, report_pb2
        self.mapping.ReportStatus(mapping_service_pb2.ReportStatusRequest(
            map="town", mission=graph_pb2.MissionId(robot=robot, mission="run"),
            link=report_pb2.LinkReport(submaps_waiting=1, bytes_waiting=bytes_waiting),
            comparison=report_pb2.ComparisonReport(revision=1, map_epoch=1, nodes=KEYFRAMES + 1, applied=True, constraints=[
                report_pb2.ConstraintCount(kind=constraint_pb2.CONSTRAINT_KIND_CHORD, added=3)])))

    @staticmethod
    def closure(from_mission, from_index, to_mission, to_index, error_m):
        from overtone.v1 import graph_pb2, submap_pb2
        import corrected_trajectory as example
        from pose import compose, inverse
        rows = circle()
        measured = compose(inverse(rows[from_index][1]), rows[to_index][1])
        position = (measured[0][0] + error_m, *measured[0][1:])
        return submap_pb2.LoopClosure(
            **{"from": graph_pb2.NodeId(mission=from_mission, index=from_index)},
            to=graph_pb2.NodeId(mission=to_mission, index=to_index),
            from_tform_to=example.to_pose((position, measured[1])), covariance=example.covariance(0.02, 0.01))

    @contextlib.contextmanager
    def connected(self, robot):
        """An upload and a watch of the robot's, open."""
        from overtone.v1 import graph_pb2, mapping_service_pb2
        frames = queue.SimpleQueue()
        mission = graph_pb2.MissionId(robot=robot, mission="run")
        frames.put(mapping_service_pb2.UploadSubmapsRequest(
            header=mapping_service_pb2.UploadHeader(map="town", mission=mission)))
        answers = self.mapping.UploadSubmaps(iter(frames.get, None))
        next(answers)  # Ready
        options = graph_pb2.GraphRequestOptions(robot=robot)
        watch = self.mapping.WatchGraph(mapping_service_pb2.WatchGraphRequest(map="town", options=options))
        next(watch)
        yield
        frames.put(None)
        watch.cancel()


def circle():
    """Eight metres a side, closed exactly: keyframe 40 is where keyframe 0 was."""
    rows = []
    for i in range(KEYFRAMES + 1):
        angle = 2 * math.pi * i / KEYFRAMES
        position = (5 * math.sin(angle), 5 * (1 - math.cos(angle)), 0.0)
        rows.append((10**18 + i * 10**9, (position, (0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)))))
    return rows


def import_example(source, stubs):
    sys.path[:0] = [str(stubs), str(source / "client/examples/03_python")]
