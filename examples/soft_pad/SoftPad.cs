// soft_pad.c in C#, for Unity and others: build it as a library first, then mcs SoftPad.cs.
//
//     cc -O2 -shared -fPIC -o libsoft_pad.so soft_pad.c -lm
using System;
using System.Runtime.InteropServices;

/// One object, pressed at several points: a state for each.
sealed class Point : IDisposable
{
    [DllImport("soft_pad")] static extern uint soft_pad_state_size();
    [DllImport("soft_pad")] static extern int soft_pad_selftest();
    [DllImport("soft_pad")] static extern void soft_pad_init(IntPtr state);
    [DllImport("soft_pad")] static extern int soft_pad_step(IntPtr state, float position_m, float velocity_mps, out float force_n);
    [DllImport("soft_pad")] static extern int soft_pad_advance(IntPtr state, float seconds, float position_m, out float force_n);
    [DllImport("soft_pad")] static extern void soft_pad_reset(IntPtr state);

    IntPtr state;

    public int Notes { get; private set; }

    public Point()
    {
        if (soft_pad_selftest() != 0)
        {
            throw new InvalidOperationException("this build gives other forces: render none");
        }
        state = Marshal.AllocHGlobal((int)soft_pad_state_size());
        soft_pad_init(state);
    }

    /// One tick of a loop of 1 kHz, beside a device.
    public float Step(float position_m, float velocity_mps)
    {
        Notes = soft_pad_step(state, position_m, velocity_mps, out float force_n);
        return Notes < 0 ? 0.0f : force_n;
    }

    /// One picture, for a force that no hand feels: the seconds since the last, and any position.
    public float Advance(float seconds, float position_m)
    {
        Notes = soft_pad_advance(state, seconds, position_m, out float force_n);
        return Notes < 0 ? 0.0f : force_n;
    }

    /// In a loop of 1 kHz after a pause, and where Notes has 32 (latched): the force comes back as a ramp.
    public void Reset() { soft_pad_reset(state); }

    ~Point() { Dispose(); }

    public void Dispose()
    {
        Marshal.FreeHGlobal(state);  // of zero: nothing
        state = IntPtr.Zero;
        GC.SuppressFinalize(this);
    }
}

static class Program
{
    static void Main()
    {
        using (Point left = new Point(), right = new Point(), alone = new Point())
        {
            for (int tick = 0; tick <= 400; tick++)
            {
                float position_m = 0.004f * tick / 400;
                float force_n = left.Step(position_m, 0.01f);
                right.Step(0.5f * position_m, 0.005f);
                if (force_n != alone.Step(position_m, 0.01f))
                {
                    throw new InvalidOperationException("two points share something");
                }
                if (tick % 100 == 0)
                {
                    Console.WriteLine("{0:F4} m {1:F3} N", position_m, force_n);
                }
            }
        }
        using (Point drawn = new Point())
        {
            float force_n = 0.0f;
            for (int picture = 1; picture <= 36; picture++)  // 0.4 s at 90 Hz
            {
                force_n = drawn.Advance(1.0f / 90.0f, 0.004f * picture / 36);
            }
            Console.WriteLine("drawn {0:F3} N", force_n);
        }
    }
}
