"""A Ray cluster of two machines in one: `python batch_cluster.py`, in a process of its own.

It prints one line of JSON, `address` and the process of each machine. A line on standard input,
`end N`, ends machine N as a power cut would; the end of the input ends the cluster.
"""

import json
import logging
import os
import sys

os.environ["RAY_USAGE_STATS_ENABLED"] = "0"

from ray.cluster_utils import Cluster

_STORE = 100_000_000


def main() -> None:
    logging.disable(logging.CRITICAL)
    cluster = Cluster()
    nodes = [
        cluster.add_node(num_cpus=1, object_store_memory=_STORE, include_dashboard=False)
        for _ in range(2)
    ]
    processes = [node.all_processes["raylet"][0].process.pid for node in nodes]
    print(json.dumps({"address": cluster.address, "processes": processes}), flush=True)
    for line in sys.stdin:
        cluster.remove_node(nodes[int(line.split()[1])], allow_graceful=False)
        print(line, end="", flush=True)
    cluster.shutdown()


if __name__ == "__main__":
    main()
