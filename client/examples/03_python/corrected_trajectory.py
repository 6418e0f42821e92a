#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A robot in Python, over generated stubs: uploads a trajectory as odometry, and writes what the server makes of it.

  ./generate_stubs.sh stubs
  PYTHONPATH=stubs ./corrected_trajectory.py odometry.tum --closures closures.txt --out corrected.tum --plot plot.svg

closures.txt: rows "i j x y z qx qy qz qw", pose j seen from pose i; both count the rows of odometry.tum from 0.
The example can be run again: what the server has already is not sent twice.
"""
import argparse
import math
import queue

import grpc

import plot
from overtone.v1 import geometry_pb2, graph_pb2, mapping_service_pb2, mapping_service_pb2_grpc, submap_pb2
from pose import IDENTITY, compose, distance, inverse, read_tum, write_tum

KEYFRAMES_PER_SUBMAP = 50


def to_pose(pose):
    (x, y, z), (qx, qy, qz, qw) = pose
    return geometry_pb2.Pose(position=geometry_pb2.Vector3(x=x, y=y, z=z),
                             orientation=geometry_pb2.Quaternion(x=qx, y=qy, z=qz, w=qw))


def from_pose(pose):
    p, q = pose.position, pose.orientation
    return ((p.x, p.y, p.z), (q.x, q.y, q.z, q.w))


def covariance(translation_sigma_m, rotation_sigma_rad):
    """Diagonal, as the upper triangle of a 6 x 6 matrix row by row; translation first."""
    variances = [translation_sigma_m**2] * 3 + [rotation_sigma_rad**2] * 3
    return geometry_pb2.PoseCovariance(
        upper_triangle=[variances[row] if row == column else 0 for row in range(6) for column in range(row, 6)])


def read_closures(path, mission):
    closures = []
    with open(path, encoding="ascii") as file:
        for line in file:
            if not line.strip() or line.startswith("#"):
                continue
            words = line.split()
            numbers = [float(word) for word in words[2:]]
            closures.append(submap_pb2.LoopClosure(
                **{"from": graph_pb2.NodeId(mission=mission, index=int(words[0]))},
                to=graph_pb2.NodeId(mission=mission, index=int(words[1])),
                from_tform_to=to_pose((tuple(numbers[:3]), tuple(numbers[3:]))),
                covariance=covariance(0.05, math.radians(1))))
    return closures


def make_submaps(rows, closures, drift, turn_drift_rad):
    """The whole mission. Odometry as it is measured, never what the server sent back: it would be counted twice."""
    submaps = []
    for first in range(0, len(rows), KEYFRAMES_PER_SUBMAP):
        submap = submap_pb2.Submap(sequence=len(submaps), first_index=first)
        for i in range(first, min(first + KEYFRAMES_PER_SUBMAP, len(rows))):
            keyframe = submap.keyframes.add(stamp_ns=rows[i][0], mission_tform_body=to_pose(rows[i][1]))
            if i > 0:  # of the motion since the keyframe before
                step = distance(rows[i][1], rows[i - 1][1])
                keyframe.motion_covariance.CopyFrom(covariance(max(1e-3, drift * step), turn_drift_rad))
        submaps.append(submap)
    for closure in closures:  # with the submap of its later end
        later = max(getattr(closure, "from").index, closure.to.index)
        submaps[later // KEYFRAMES_PER_SUBMAP].loop_closures.append(closure)
    return submaps


def upload(stub, map_name, mission, submaps):
    """Returns when the server has stored all of them."""
    frames = queue.SimpleQueue()
    frames.put(mapping_service_pb2.UploadSubmapsRequest(
        header=mapping_service_pb2.UploadHeader(map=map_name, mission=mission)))
    for answer in stub.UploadSubmaps(iter(frames.get, None)):
        if answer.HasField("ready"):
            next_sequence = answer.ready.next_sequence
        elif answer.HasField("ack"):
            next_sequence = answer.ack.durable_through_sequence + 1
        elif answer.HasField("reject"):
            raise RuntimeError(f"submap {answer.reject.sequence}: {answer.reject.message}")
        else:
            continue
        # One under way at a time: a robot would use the window that Ready names.
        done = next_sequence >= len(submaps)
        frames.put(None if done else mapping_service_pb2.UploadSubmapsRequest(submap=submaps[next_sequence]))


def corrected_nodes(stub, map_name, mission, last_index):
    """{index: map_tform_body} of the first graph that holds the mission's last keyframe."""
    options = graph_pb2.GraphRequestOptions(robot=mission.robot, encoding=graph_pb2.GRAPH_ENCODING_PLAIN)
    watch = stub.WatchGraph(mapping_service_pb2.WatchGraphRequest(map=map_name, options=options))
    for frame in watch:  # the frames say when; the whole graph is asked for, which spares us deltas
        if not frame.HasField("heartbeat") or frame.heartbeat.revision > 0:
            graph = stub.GetGraph(mapping_service_pb2.GetGraphRequest(map=map_name, options=options)).graph
            for nodes in graph.missions:
                if nodes.id == mission and nodes.nodes and nodes.nodes[-1].index == last_index:
                    watch.cancel()
                    return {node.index: from_pose(node.map_tform_body) for node in nodes.nodes}
    raise RuntimeError("the server ended the stream")


def correct(rows, nodes):
    """Every row: those between two nodes go along with the one before them."""
    corrected, anchor = [], (IDENTITY, IDENTITY)  # the node's pose by odometry and in the map
    for index, (stamp, odometry) in enumerate(rows):
        if index in nodes:
            anchor = (odometry, nodes[index])
        corrected.append((stamp, compose(anchor[1], compose(inverse(anchor[0]), odometry))))
    return corrected


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("odometry", help="TUM file")
    parser.add_argument("--server", default="localhost:7077", help="host:port")
    parser.add_argument("--map", default="default")
    parser.add_argument("--robot", default="snake")
    parser.add_argument("--mission", default="run")
    parser.add_argument("--closures", help="file of loop closures")
    parser.add_argument("--drift", type=float, default=0.02, help="sigma of a step, share of its length")
    parser.add_argument("--turn-drift-deg", type=float, default=0.5, help="sigma of a step")
    parser.add_argument("--out", default="corrected.tum", help="TUM file")
    parser.add_argument("--plot", help="picture, e.g. plot.svg")
    arguments = parser.parse_args()

    rows = read_tum(arguments.odometry)
    mission = graph_pb2.MissionId(robot=arguments.robot, mission=arguments.mission)
    closures = read_closures(arguments.closures, mission) if arguments.closures else []
    submaps = make_submaps(rows, closures, arguments.drift, math.radians(arguments.turn_drift_deg))
    # With certificates: grpc.secure_channel, see docs/security.md.
    with grpc.insecure_channel(arguments.server) as channel:
        stub = mapping_service_pb2_grpc.MappingServiceStub(channel)
        upload(stub, arguments.map, mission, submaps)
        nodes = corrected_nodes(stub, arguments.map, mission, len(rows) - 1)
    corrected = correct(rows, nodes)
    write_tum(arguments.out, corrected)
    if arguments.plot:
        plot.draw(arguments.plot, [pose[0] for _, pose in rows], [pose[0] for _, pose in corrected])
    print(f"{len(rows)} poses in {len(submaps)} submaps, {len(closures)} closures; the last pose moved "
          f"{distance(rows[-1][1], corrected[-1][1]):.3f} m; written to {arguments.out}")


if __name__ == "__main__":
    main()
