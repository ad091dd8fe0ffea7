#!/usr/bin/env python3
"""The same epoch with PyTorch on the CPU, and both in turns.

    python3 -m venv /tmp/torch && /tmp/torch/bin/pip install torch numpy
    cargo bench --workspace --profile dev --bench paper_epoch --no-run
    /tmp/torch/bin/python crates/stick3d_train/benches/paper_epoch.py PATH/OF/THE/paper_epoch-BINARY [ROUNDS [BATCH]]

Prints the seconds of each epoch, the least and the median of both, and the ratio of these.
"""

import statistics
import subprocess
import sys
import time

import torch
from torch import nn

SAMPLES, COORDINATES, HIDDEN, LATENT, ALPHA = 1512, 37_500, 512, 256, 1e5


class Autoencoder(nn.Module):
    def __init__(self):
        super().__init__()
        self.trunk = nn.Sequential(
            nn.Linear(COORDINATES, HIDDEN), nn.ReLU(), nn.Linear(HIDDEN, HIDDEN), nn.ReLU()
        )
        self.mean = nn.Linear(HIDDEN, LATENT)
        self.log_variance = nn.Linear(HIDDEN, LATENT)
        self.decoder = nn.Sequential(
            nn.Linear(LATENT, HIDDEN), nn.ReLU(), nn.Linear(HIDDEN, HIDDEN), nn.ReLU(),
            nn.Linear(HIDDEN, COORDINATES), nn.Tanh(),
        )

    def loss(self, bodies):
        hidden = self.trunk(bodies)
        mean, log_variance = self.mean(hidden), self.log_variance(hidden)
        latent = mean + torch.exp(0.5 * log_variance) * torch.randn_like(mean)
        squared = (self.decoder(latent) - bodies).square().mean()
        divergence = 0.5 * (mean.square() + log_variance.exp() - log_variance - 1).sum(1).mean()
        return ALPHA * squared + divergence


def epoch(model, optimiser, bodies, batch):
    start = time.perf_counter()
    order = torch.randperm(SAMPLES)
    count = max(round(SAMPLES / batch), 1)
    for picks in order.split(-(-SAMPLES // count)):
        optimiser.zero_grad(set_to_none=True)
        loss = model.loss(bodies[picks])
        loss.backward()
        optimiser.step()
        loss.item()
    return time.perf_counter() - start


def main():
    binary = sys.argv[1]
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    batch = int(sys.argv[3]) if len(sys.argv) > 3 else 64
    torch.manual_seed(1)
    bodies = torch.rand(SAMPLES, COORDINATES) * 1.4 - 0.7
    model = Autoencoder()
    with torch.no_grad():
        model.log_variance.bias.fill_(-4)
    # The fastest that PyTorch has for the CPU: one fused loop over the parameters.
    optimiser = torch.optim.Adam(model.parameters(), lr=1e-3, fused=True)
    epoch(model, optimiser, bodies, batch)
    ours, theirs = [], []
    for _ in range(rounds):
        theirs += [epoch(model, optimiser, bodies, batch) for _ in range(2)]
        out = subprocess.run([binary, "3", str(batch)], capture_output=True, text=True, check=True)
        ours += [float(line.split()[1]) for line in out.stdout.splitlines() if line.startswith("epoch_s")][1:]
    print(f"PyTorch {torch.__version__}, {torch.get_num_threads()} threads, batch {batch}")
    for name, seconds in [("stick3d", ours), ("PyTorch", theirs)]:
        print(f"{name}: {' '.join(f'{s:.2f}' for s in seconds)}  "
              f"least {min(seconds):.2f} s, median {statistics.median(seconds):.2f} s")
    print(f"ratio of the least {min(ours) / min(theirs):.2f}, "
          f"of the medians {statistics.median(ours) / statistics.median(theirs):.2f}")


if __name__ == "__main__":
    main()
