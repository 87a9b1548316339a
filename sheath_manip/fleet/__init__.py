"""Several robots and one person: each robot in a process of its own, one queue of requests.

Each robot has its own environment, policy, gate and cockpit in its process, which hold it by
themselves where nobody is heard of. Here is what the page shows of them and passes on to them.
"""
